//! Wavefront OBJ.
//!
//! The text is scanned once by ourselves: every number and index is checked there, where its line is known, and names
//! are noted. What passes is written out again in its plainest form (no comments, no continuations, absolute indices,
//! one kind of corner throughout) and read by `tobj`, which then cannot fail.

use std::io::{self, BufRead, Read, Write};
use std::rc::Rc;

use glam::{Vec2, Vec3};

use super::build::Parts;
use super::{FileBytes, LoadError, MAX_VERTICES, ObjProblem, STEPS, barrier};
use crate::geometry::polygon;
use crate::task::{Task, Warning};

/// The most corners a face may have: cutting takes the square of it.
const MAX_CORNERS: usize = 4096;

/// The most groups a face may be in, and the most letters of a name that are kept.
const MAX_NAMES: (usize, usize) = (16, 256);

/// A face's corners and names.
struct Face {
    line: usize,
    /// Range in [`Scan::corners`].
    corners: std::ops::Range<usize>,
    /// Index into [`Scan::names`].
    names: usize,
}

/// A corner with its indices counted from the start of the file.
#[derive(Clone, Copy)]
struct Corner {
    /// 1-based; 0: not given.
    position: u32,
    uv: u32,
    normal: u32,
}

#[derive(Default)]
struct Scan {
    /// `v`, `vt` and `vn` lines for tobj.
    text: Vec<u8>,
    /// How many `v`, `vt`, `vn`.
    counts: [usize; 3],
    corners: Vec<Corner>,
    faces: Vec<Face>,
    /// Each distinct run of object, groups and material.
    names: Vec<Vec<Rc<str>>>,
    object: Option<Rc<str>>,
    groups: Vec<Rc<str>>,
    material: Option<Rc<str>>,
    is_renamed: bool,
    ignored: usize,
    /// Free-form curves and surfaces.
    free_form: usize,
    unknown: usize,
    first_unknown: Option<(usize, String)>,
    has_vertices: bool,
}

/// Reads an OBJ file.
pub(super) fn read(file: &FileBytes, task: &Task) -> Result<Parts, LoadError> {
    let mut scan = Scan { is_renamed: true, ..Scan::default() };
    let bytes = file.bytes.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(file.bytes);
    for_each_line(bytes, |line, text| {
        if line % STEPS == 0 {
            task.check()?;
        }
        scan.line(text, line).map_err(|problem| LoadError::Obj { line, problem })?;
        match scan.faces.last() {
            Some(face) if face.corners.len() > MAX_CORNERS => Err(LoadError::TooMuch {
                what: format!("corners in the face at line {line}"),
                count: face.corners.len() as u64,
                limit: MAX_CORNERS as u64,
            }),
            _ => Ok(()),
        }
    })?;
    if !scan.has_vertices && scan.faces.is_empty() && scan.ignored == 0 {
        return Err(LoadError::NotAMesh { name: file.name.to_owned(), what: "it has no `v` and no `f` lines" });
    }
    for (what, count) in [("vertices", scan.counts[0]), ("corners of faces", scan.corners.len())] {
        if count as u64 > 3 * MAX_VERTICES {
            return Err(LoadError::TooMuch { what: what.into(), count: count as u64, limit: 3 * MAX_VERTICES });
        }
    }
    task.check()?;
    scan.check_range(bytes)?;
    scan.build(task)
}

/// Calls `each` with the number of the first line and the text of every logical line: a `\` at the end of a line
/// joins the next to it.
fn for_each_line(bytes: &[u8], mut each: impl FnMut(usize, &str) -> Result<(), LoadError>) -> Result<(), LoadError> {
    let mut joined = Vec::new();
    let mut start = 1;
    // Old Macintosh files end lines by `\r` alone.
    let ends_by_cr = !bytes.contains(&b'\n');
    let lines = bytes.split(|&b| b == b'\n' || (ends_by_cr && b == b'\r'));
    let count = lines.clone().count();
    for (i, line) in lines.enumerate() {
        let line = line.strip_suffix(b"\r").unwrap_or(line);
        let open = line.strip_suffix(b"\\").filter(|_| i + 1 < count);
        if joined.is_empty() {
            start = i + 1;
        }
        if let Some(open) = open {
            joined.extend_from_slice(open);
            joined.push(b' ');
            continue;
        }
        if joined.is_empty() {
            each(start, &String::from_utf8_lossy(line))?;
        } else {
            joined.extend_from_slice(line);
            each(start, &String::from_utf8_lossy(&joined))?;
            joined.clear();
        }
    }
    Ok(())
}

/// A piece of a line, short enough for a message.
fn short(text: &str) -> String {
    if text.chars().count() <= 40 { text.to_owned() } else { text.chars().take(37).chain("...".chars()).collect() }
}

/// A name, if there is one, of sensible length.
fn name(text: &str) -> Option<Rc<str>> {
    let end = text.char_indices().nth(MAX_NAMES.1).map_or(text.len(), |(at, _)| at);
    (end > 0).then(|| Rc::from(&text[..end]))
}

impl Scan {
    fn line(&mut self, text: &str, line: usize) -> Result<(), ObjProblem> {
        // A `#` within a word belongs to it: `usemtl skin#2`, or the `1.#IND` that old programs write for NaN.
        let comment = text.match_indices('#').find(|&(at, _)| at == 0 || text[..at].ends_with([' ', '\t']));
        let text = comment.map_or(text, |(at, _)| &text[..at]);
        // What old editors leave at the end of a file.
        let text = text.trim_end_matches(['\0', '\x1a']);
        let mut words = text.split_ascii_whitespace();
        let Some(keyword) = words.next() else { return Ok(()) };
        let rest = text.trim_ascii()[keyword.len()..].trim_ascii();
        match keyword {
            "v" => {
                self.has_vertices = true;
                self.numbers("v", 0, 3, 3, words)?;
            }
            "vt" => self.numbers("vt", 1, 1, 2, words)?,
            "vn" => self.numbers("vn", 2, 3, 3, words)?,
            "f" | "fo" => self.face(words, line)?,
            "o" => self.rename(|s| s.object = name(rest)),
            "g" => {
                let groups: Vec<Rc<str>> = words.filter_map(name).collect();
                if groups.len() > MAX_NAMES.0 {
                    return Err(ObjProblem::Names { got: groups.len(), limit: MAX_NAMES.0 });
                }
                self.rename(|s| s.groups = groups);
            }
            "usemtl" => self.rename(|s| s.material = name(rest)),
            "p" | "l" => self.ignored += 1,
            "curv" | "curv2" | "surf" => self.free_form += 1,
            "s" | "mtllib" | "usemap" | "maplib" | "vp" | "cstype" | "deg" | "bmat" | "step" | "parm" | "trim"
            | "hole" | "scrv" | "sp" | "end" | "con" | "mg" | "bevel" | "c_interp" | "d_interp" | "lod"
            | "shadow_obj" | "trace_obj" | "ctech" | "stech" | "call" | "csh" => {}
            _ => {
                self.unknown += 1;
                self.first_unknown.get_or_insert_with(|| (line, short(keyword)));
            }
        }
        Ok(())
    }

    fn rename(&mut self, change: impl FnOnce(&mut Self)) {
        change(self);
        self.is_renamed = true;
    }

    /// Checks the numbers of a `v`, `vt` or `vn` line and writes the first of them out.
    fn numbers<'a>(
        &mut self,
        keyword: &'static str,
        kind: usize,
        wanted: usize,
        written: usize,
        words: impl Iterator<Item = &'a str>,
    ) -> Result<(), ObjProblem> {
        self.text.extend_from_slice(keyword.as_bytes());
        let mut got = 0;
        for word in words.take(written) {
            let value: f32 = word.parse().map_err(|_| ObjProblem::NotANumber(short(word)))?;
            if !value.is_finite() {
                return Err(ObjProblem::NotFinite(short(word)));
            }
            self.text.push(b' ');
            self.text.extend_from_slice(word.as_bytes());
            got += 1;
        }
        if got < wanted {
            return Err(ObjProblem::TooFew { keyword, wanted, got });
        }
        // A one-dimensional uv.
        for _ in got..written {
            self.text.extend_from_slice(b" 0");
        }
        self.text.push(b'\n');
        self.counts[kind] += 1;
        Ok(())
    }

    fn face<'a>(&mut self, words: impl Iterator<Item = &'a str>, line: usize) -> Result<(), ObjProblem> {
        let start = self.corners.len();
        for word in words {
            let bad = || ObjProblem::Corner(short(word));
            let mut fields = word.split('/');
            let mut index = |kind: usize| -> Result<u32, ObjProblem> {
                let Some(text) = fields.next().filter(|t| !t.is_empty()) else { return Ok(0) };
                let index: i64 = text.parse().map_err(|_| bad())?;
                let count = self.counts[kind];
                match index {
                    0 => Err(ObjProblem::Zero(short(word))),
                    1.. => u32::try_from(index).map_err(|_| out_of_range(word, kind, index, count)),
                    // Counted back from the lines above; forwards is looked at once all lines are known.
                    ..0 => (count as i64)
                        .checked_add(index + 1)
                        .and_then(|i| u32::try_from(i).ok())
                        .filter(|&i| i > 0)
                        .ok_or_else(|| out_of_range(word, kind, index, count)),
                }
            };
            let corner = Corner { position: index(0)?, uv: index(1)?, normal: index(2)? };
            if corner.position == 0 || fields.next().is_some() {
                return Err(bad());
            }
            self.corners.push(corner);
        }
        let corners = start..self.corners.len();
        if corners.len() < 3 {
            return Err(ObjProblem::Corners(corners.len()));
        }
        if self.is_renamed {
            let mut names = Vec::new();
            for name in self.object.iter().chain(&self.groups).chain(&self.material) {
                if !names.contains(name) {
                    names.push(name.clone());
                }
            }
            self.names.push(names);
            self.is_renamed = false;
        }
        self.faces.push(Face { line, corners, names: self.names.len() - 1 });
        Ok(())
    }

    /// Positive indices may name what comes further down, so they are checked at the end.
    fn check_range(&self, bytes: &[u8]) -> Result<(), LoadError> {
        let counts = self.counts;
        let beyond = |c: &Corner| [c.position, c.uv, c.normal].iter().zip(counts).any(|(&i, count)| i as usize > count);
        for face in &self.faces {
            let Some(at) = self.corners[face.corners.clone()].iter().position(beyond) else { continue };
            let corner = self.corners[face.corners.start + at];
            let indices = [corner.position, corner.uv, corner.normal];
            let kind = (0..3).find(|&k| indices[k] as usize > counts[k]).unwrap_or(0);
            // Once more to the line, for the corner as it is written there.
            let mut written = String::new();
            for_each_line(bytes, |line, text| {
                if line == face.line {
                    written = text.split_ascii_whitespace().nth(1 + at).map(short).unwrap_or_default();
                }
                Ok(())
            })?;
            let problem = out_of_range(&written, kind, i64::from(indices[kind]), counts[kind]);
            return Err(LoadError::Obj { line: face.line, problem });
        }
        Ok(())
    }

    fn build(mut self, task: &Task) -> Result<Parts, LoadError> {
        let mut parts = Parts { ignored: self.ignored, ..Parts::default() };
        self.warn(&mut parts.warnings);
        if self.faces.is_empty() {
            return Err(LoadError::NoTriangles { dropped: 0, ignored: self.ignored });
        }
        let (has_uv, has_normal) = (self.corners.iter().any(|c| c.uv != 0), self.corners.iter().any(|c| c.normal != 0));
        self.write_faces(has_uv, has_normal);
        let read = barrier::guarded("OBJ", || self.parse(task))?;
        task.check()?;
        let bare_uv = Vec2::splat(BARE);
        let vector = |list: &[f32], i: usize| Vec3::new(list[3 * i], list[3 * i + 1], list[3 * i + 2]);
        let count = read.positions.len() / 3;
        parts.positions = (0..count).map(|i| vector(&read.positions, i)).collect();
        parts.normals = vec![Vec3::ZERO; count];
        if has_normal {
            parts.normals = (0..count).map(|i| vector(&read.normals, i)).collect();
        }
        parts.uvs = vec![None; count];
        if has_uv {
            let uv = |i: usize| Vec2::new(read.texcoords[2 * i], read.texcoords[2 * i + 1]);
            parts.uvs = (0..count).map(|i| Some(uv(i)).filter(|&uv| uv != bare_uv)).collect();
        }

        // Cut the faces; tobj keeps their order.
        let numbers: Vec<Vec<usize>> =
            self.names.iter().map(|names| names.iter().map(|name| parts.group(name)).collect()).collect();
        let mut indices = &read.indices[..];
        let mut corners = Vec::new();
        for (f, face) in self.faces.iter().enumerate() {
            if f % STEPS == 0 {
                task.check()?;
            }
            let Some((polygon, rest)) = indices.split_at_checked(face.corners.len()) else {
                return Err(LoadError::Reader { format: "OBJ", problem: "a face is missing".into() });
            };
            indices = rest;
            corners.clear();
            corners.extend(polygon.iter().map(|&v| parts.positions[v as usize]));
            let first = parts.triangles.len();
            for triangle in polygon::triangulate(&corners) {
                parts.triangles.push(triangle.map(|k| polygon[k as usize]));
            }
            for &group in &numbers[face.names] {
                parts.enlist(group, first)?;
            }
        }
        Ok(parts)
    }

    fn warn(&self, warnings: &mut Vec<Warning>) {
        if self.free_form > 0 {
            let message = format!("free-form curves and surfaces left out: `{}`", self.free_form);
            warnings.push(Warning::new(message).hint("convert them to polygons"));
        }
        if let Some((line, keyword)) = &self.first_unknown {
            let message = format!("lines not understood: `{}`, the first is line {line}: `{keyword}`", self.unknown);
            warnings.push(Warning::new(message));
        }
    }

    /// Writes the faces with the same kind of corner throughout.
    fn write_faces(&mut self, has_uv: bool, has_normal: bool) {
        let mut bare = [0; 2];
        if has_uv && self.corners.iter().any(|c| c.uv == 0) {
            self.text.extend_from_slice(format!("vt {BARE} {BARE}\n").as_bytes());
            bare[0] = self.counts[1] as u32 + 1;
        }
        if has_normal && self.corners.iter().any(|c| c.normal == 0) {
            self.text.extend_from_slice(b"vn 0 0 0\n");
            bare[1] = self.counts[2] as u32 + 1;
        }
        for face in &self.faces {
            self.text.push(b'f');
            for c in &self.corners[face.corners.clone()] {
                let uv = if c.uv == 0 { bare[0] } else { c.uv };
                let normal = if c.normal == 0 { bare[1] } else { c.normal };
                // Writing to memory does not fail.
                let _ = match (has_uv, has_normal) {
                    (true, true) => write!(self.text, " {}/{uv}/{normal}", c.position),
                    (true, false) => write!(self.text, " {}/{uv}", c.position),
                    (false, true) => write!(self.text, " {}//{normal}", c.position),
                    (false, false) => write!(self.text, " {}", c.position),
                };
            }
            self.text.push(b'\n');
        }
    }

    fn parse(&self, task: &Task) -> Result<tobj::Mesh, LoadError> {
        let options = tobj::LoadOptions { single_index: true, ..tobj::LoadOptions::default() };
        let refused = |problem: String| LoadError::Reader { format: "OBJ", problem };
        let no_materials = |_: &std::path::Path| Ok((Vec::new(), Default::default()));
        let mut text = Polled { text: &self.text, task };
        let read = tobj::load_obj_buf(&mut text, &options, no_materials);
        // The reader calls a cancelled text a bad one.
        task.check()?;
        let (models, _) = read.map_err(|e| refused(e.to_string()))?;
        match <[tobj::Model; 1]>::try_from(models) {
            Ok([model]) => Ok(model.mesh),
            Err(models) => Err(refused(format!("{} models for one", models.len()))),
        }
    }
}

/// A text that ends with an error when the task is cancelled.
struct Polled<'a> {
    text: &'a [u8],
    task: &'a Task,
}

/// Bytes that are handed out between two looks at the task.
const PIECE: usize = 1 << 16;

impl Read for Polled<'_> {
    fn read(&mut self, into: &mut [u8]) -> io::Result<usize> {
        let count = self.fill_buf()?.read(into)?;
        self.consume(count);
        Ok(count)
    }
}

impl BufRead for Polled<'_> {
    fn fill_buf(&mut self) -> io::Result<&[u8]> {
        self.task.check().map_err(io::Error::other)?;
        Ok(&self.text[..self.text.len().min(PIECE)])
    }

    fn consume(&mut self, count: usize) {
        self.text = self.text.get(count..).unwrap_or_default();
    }
}

/// Stands for "no uv" on the way through tobj, which wants one at every corner or at none: the most negative `f32`.
const BARE: f32 = f32::MIN;

fn out_of_range(corner: &str, kind: usize, index: i64, count: usize) -> ObjProblem {
    let what = ["vertex", "uv", "normal"][kind];
    ObjProblem::OutOfRange { corner: short(corner), what, index, count }
}
