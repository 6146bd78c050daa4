//! Small files for the tests of loading, made by code.

/// A cube of 1 cm from the origin on, of quads that face outward.
pub const CUBE: &str = "\
v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1
g sides\nusemtl skin\nf 1 4 3 2\nf 5 6 7 8\nf 1 5 8 4\nf 2 3 7 6
g caps\nusemtl\nf 1 2 6 5\nf 4 8 7 3
";

/// A binary glTF in the making.
#[derive(Clone)]
pub struct Glb {
    pub json: String,
    pub data: Vec<u8>,
}

fn floats(values: &[f32]) -> Vec<u8> {
    values.iter().flat_map(|v| v.to_le_bytes()).collect()
}

fn view(offset: usize, length: usize) -> String {
    format!("{{\"buffer\":0,\"byteOffset\":{offset},\"byteLength\":{length}}}")
}

const SQUARE: [f32; 12] = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 1.0, 0.0];

impl Glb {
    /// The file, as it would lie on a disk.
    pub fn bytes(&self) -> Vec<u8> {
        let mut json = self.json.clone().into_bytes();
        json.resize(json.len().next_multiple_of(4), b' ');
        let mut data = self.data.clone();
        data.resize(data.len().next_multiple_of(4), 0);
        let length = 12 + 8 + json.len() + 8 + data.len();
        let word = |n: usize| (n as u32).to_le_bytes();
        [b"glTF", &word(2)[..], &word(length), &word(json.len()), b"JSON", &json, &word(data.len()), b"BIN\0", &data]
            .concat()
    }

    /// With a piece of its JSON replaced, once.
    pub fn replace(&self, from: &str, to: &str) -> Self {
        assert!(self.json.contains(from), "{from} is not in {}", self.json);
        Self { json: self.json.replacen(from, to, 1), data: self.data.clone() }
    }

    /// JSON that refers to its data, and the data.
    pub fn apart(&self, uri: &str) -> (String, Vec<u8>) {
        (self.json.replace("\"buffers\":[{", &format!("\"buffers\":[{{\"uri\":\"{uri}\",")), self.data.clone())
    }

    /// The data as a uri.
    pub fn data_uri(&self) -> String {
        const DIGITS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
        let mut text = String::from("data:application/octet-stream;base64,");
        for group in self.data.chunks(3) {
            let bits = group.iter().fold(0_u32, |bits, &b| bits << 8 | u32::from(b)) << (8 * (3 - group.len()));
            for k in 0..4 {
                let digit = char::from(DIGITS[(bits >> (18 - 6 * k) & 63) as usize]);
                text.push(if k <= group.len() { digit } else { '=' });
            }
        }
        text
    }

    /// A square of 1 m with uv, as a primitive of that mode.
    pub fn square(mode: u32, indices: Option<&[u32]>) -> Self {
        let mut data = floats(&SQUARE);
        data.extend(floats(&[0.0, 0.0, 1.0, 0.0, 1.0, 1.0, 0.0, 1.0]));
        let (mut views, mut accessors, mut uses) = (view(0, 48) + "," + &view(48, 32), String::new(), String::new());
        accessors += "{\"bufferView\":0,\"componentType\":5126,\"count\":4,\"type\":\"VEC3\"},";
        accessors += "{\"bufferView\":1,\"componentType\":5126,\"count\":4,\"type\":\"VEC2\"}";
        if let Some(indices) = indices {
            views = views + "," + &view(80, 4 * indices.len());
            data.extend(indices.iter().flat_map(|i| i.to_le_bytes()));
            accessors += &format!(
                ",{{\"bufferView\":2,\"componentType\":5125,\"count\":{},\"type\":\"SCALAR\"}}",
                indices.len()
            );
            uses += ",\"indices\":2";
        }
        let json = format!(
            "{{\"asset\":{{\"version\":\"2.0\"}},\"scenes\":[{{\"nodes\":[0]}}],\"nodes\":[{{\"mesh\":0}}],\
             \"meshes\":[{{\"primitives\":[{{\"mode\":{mode},\"attributes\":{{\"POSITION\":0,\"TEXCOORD_0\":1}}{uses}}}]}}],\
             \"accessors\":[{accessors}],\"bufferViews\":[{views}],\"buffers\":[{{\"byteLength\":{}}}]}}",
            data.len()
        );
        Self { json, data }
    }

    /// The square in normalised u16, four apart.
    pub fn quantised() -> Self {
        let data = SQUARE
            .chunks(3)
            .flat_map(|p| [p[0], p[1], p[2], 0.0])
            .flat_map(|c| ((c * 65535.0) as u16).to_le_bytes())
            .collect();
        let json = "{\"asset\":{\"version\":\"2.0\"},\"extensionsRequired\":[\"KHR_mesh_quantization\"],\"nodes\":[{\"mesh\":0}],\
            \"meshes\":[{\"primitives\":[{\"mode\":6,\"attributes\":{\"POSITION\":0}}]}],\
            \"accessors\":[{\"bufferView\":0,\"componentType\":5123,\"normalized\":true,\"count\":4,\"type\":\"VEC3\"}],\
            \"bufferViews\":[{\"buffer\":0,\"byteLength\":32,\"byteStride\":8}],\"buffers\":[{\"byteLength\":32}]}";
        Self { json: json.into(), data }
    }

    /// The square with its third corner moved to (2, 2, 0).
    pub fn sparse() -> Self {
        let mut square = Self::square(6, None);
        let offset = square.data.len();
        square.data.extend([2, 0, 0, 0]);
        square.data.extend(floats(&[2.0, 2.0, 0.0]));
        let views =
            format!(",{},{}],\"buffers\":[{{\"byteLength\":{}}}", view(offset, 4), view(offset + 4, 12), offset + 16);
        square
            .replace(
                "\"count\":4,\"type\":\"VEC3\"",
                "\"count\":4,\"type\":\"VEC3\",\"sparse\":{\"count\":1,\
                 \"indices\":{\"bufferView\":2,\"componentType\":5123},\"values\":{\"bufferView\":3}}",
            )
            .replace("],\"buffers\":[{\"byteLength\":80}", &views)
    }
}

/// Places and normals of a box around the origin, four for each side, and its triangles.
fn cube(half: f32) -> (Vec<f32>, Vec<f32>, Vec<u32>) {
    let (mut places, mut normals, mut indices) = (Vec::new(), Vec::new(), Vec::new());
    for side in 0..6 {
        let (axis, sign) = (side % 3, if side < 3 { 1.0 } else { -1.0 });
        for (a, b) in [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)] {
            let mut place = [0.0; 3];
            (place[axis], place[(axis + 1) % 3], place[(axis + 2) % 3]) = (sign * half, a * half * sign, b * half);
            let mut normal = [0.0; 3];
            normal[axis] = sign;
            places.extend(place);
            normals.extend(normal);
        }
        indices.extend([0, 1, 2, 0, 2, 3].map(|i| i + 4 * side as u32));
    }
    (places, normals, indices)
}

/// A "head": a box of 20 cm, 1.6 m up, under a root node.
pub fn head_glb() -> Glb {
    let (places, normals, indices) = cube(0.1);
    let mut data = floats(&places);
    data.extend(floats(&normals));
    data.extend(indices.iter().flat_map(|i| i.to_le_bytes()));
    let json = format!(
        "{{\"asset\":{{\"version\":\"2.0\"}},\"scene\":0,\"scenes\":[{{\"nodes\":[0]}}],\
         \"nodes\":[{{\"name\":\"root\",\"children\":[1]}},{{\"name\":\"head\",\"mesh\":0,\"translation\":[0,1.6,0]}}],\
         \"materials\":[{{\"name\":\"skin\"}}],\"meshes\":[{{\"name\":\"Head mesh\",\"primitives\":[{{\
         \"attributes\":{{\"POSITION\":0,\"NORMAL\":1}},\"indices\":2,\"material\":0,\"mode\":4}}]}}],\
         \"accessors\":[{{\"bufferView\":0,\"componentType\":5126,\"count\":24,\"type\":\"VEC3\"}},\
         {{\"bufferView\":1,\"componentType\":5126,\"count\":24,\"type\":\"VEC3\"}},\
         {{\"bufferView\":2,\"componentType\":5125,\"count\":36,\"type\":\"SCALAR\"}}],\
         \"bufferViews\":[{},{},{}],\"buffers\":[{{\"byteLength\":{}}}]}}",
        view(0, 288),
        view(288, 288),
        view(576, 144),
        data.len()
    );
    Glb { json, data }
}

/// A box of 20 cm stored in cm, skinned to a skeleton whose root shrinks by 100; the upper half hangs half on the tip.
pub fn skinned_glb() -> Glb {
    let (places, _, indices) = cube(10.0);
    let mut data = floats(&places);
    data.extend(places.chunks(3).flat_map(|_| [0_u8, 1, 0, 0]));
    data.extend(
        places.chunks(3).flat_map(|p| floats(if p[1] > 0.0 { &[0.5, 0.5, 0.0, 0.0] } else { &[1.0, 0.0, 0.0, 0.0] })),
    );
    data.extend(indices.iter().flat_map(|i| i.to_le_bytes()));
    let binds = data.len();
    for _ in 0..2 {
        data.extend(floats(&glam::Mat4::IDENTITY.to_cols_array()));
    }
    let json = format!(
        "{{\"asset\":{{\"version\":\"2.0\"}},\"scenes\":[{{\"nodes\":[0,3]}}],\"nodes\":[\
         {{\"name\":\"armature\",\"scale\":[0.01,0.01,0.01],\"children\":[1]}},{{\"name\":\"hip\",\"children\":[2]}},\
         {{\"name\":\"tip\"}},{{\"name\":\"body\",\"mesh\":0,\"skin\":0,\"translation\":[9,9,9]}}],\
         \"skins\":[{{\"joints\":[1,2],\"inverseBindMatrices\":4}}],\"meshes\":[{{\"primitives\":[{{\
         \"attributes\":{{\"POSITION\":0,\"JOINTS_0\":1,\"WEIGHTS_0\":2}},\"indices\":3}}]}}],\
         \"accessors\":[{{\"bufferView\":0,\"componentType\":5126,\"count\":24,\"type\":\"VEC3\"}},\
         {{\"bufferView\":1,\"componentType\":5121,\"count\":24,\"type\":\"VEC4\"}},\
         {{\"bufferView\":2,\"componentType\":5126,\"count\":24,\"type\":\"VEC4\"}},\
         {{\"bufferView\":3,\"componentType\":5125,\"count\":36,\"type\":\"SCALAR\"}},\
         {{\"bufferView\":4,\"componentType\":5126,\"count\":2,\"type\":\"MAT4\"}}],\
         \"bufferViews\":[{},{},{},{},{}],\"buffers\":[{{\"byteLength\":{}}}]}}",
        view(0, 288),
        view(288, 96),
        view(384, 384),
        view(768, 144),
        view(binds, 128),
        data.len()
    );
    Glb { json, data }
}
