//! Contact sheets, scripted tests and comparisons, by the real program in a folder of its own.

use std::path::Path;
use std::process::{Command, Output, Stdio};

use coif::render::{Picture, png};

const STYLE: &str = r##"
local p = coif.params {
  count  = { 12, min = 1, max = 100, integer = true, doc = "how many guides" },
  length = { 4, min = 1, max = 20, unit = "cm" },
  colour = "#503020",
  way    = { "down", choices = { "down", "back" } },
}
local head = coif.head()
local direction = p.way == "down" and coif.down or { 0, -0.3, -1 }
local queue = coif.queue { coif.domain.directional { box = head:box("all"), direction = direction, noise = 0.2 } }
local hair = head:scalp():guides { count = p.count, length = p.length, step = 1 }:grow { global = queue }
  :fill { strands = 120, material = { root_colour = p.colour, width = 0.2 } }
return coif.scene { head, hair, views = { "front", "left" } }
"##;

const TEST: &str = r#"
coif.test("figures", function(t)
  local scene = t:run "style.lua" { count = 20 }
  t:equal(scene.hair:stats().strands, 120)
  t:equal(scene.hair:stats().inside, 0)
end)
coif.test("picture", function(t)
  t:preview(t:run "style.lua", "style", { size = 48, views = { "front", "left" } })
end)
"#;

/// A folder with these files.
fn folder(files: &[(&str, &str)]) -> tempfile::TempDir {
    let dir = tempfile::tempdir().unwrap();
    for (name, text) in files {
        std::fs::write(dir.path().join(name), text).unwrap();
    }
    dir
}

/// Runs the program: (exit code, standard output, standard error).
fn coif(dir: &Path, arguments: &[&str]) -> (i32, String, String) {
    let Output { status, stdout, stderr } = Command::new(env!("CARGO_BIN_EXE_coif"))
        .args(arguments)
        .current_dir(dir)
        .stdin(Stdio::null())
        .output()
        .unwrap();
    let text = |bytes: Vec<u8>| String::from_utf8(bytes).unwrap();
    (status.code().unwrap_or(-1), text(stdout), text(stderr))
}

fn names(dir: &Path) -> Vec<String> {
    let Ok(entries) = std::fs::read_dir(dir) else { return vec![] };
    let mut names: Vec<String> = entries.map(|e| e.unwrap().file_name().to_string_lossy().into_owned()).collect();
    names.sort();
    names
}

fn picture(path: impl AsRef<Path>) -> Picture {
    png::decode(&std::fs::read(path).unwrap()).unwrap()
}

/// A rectangle of a picture.
fn crop(p: &Picture, x: u32, y: u32, width: u32, height: u32) -> Picture {
    let row = |y: u32| ((y * p.width + x) * 3) as usize..((y * p.width + x + width) * 3) as usize;
    Picture { width, height, pixels: (y..y + height).flat_map(|y| p.pixels[row(y)].to_vec()).collect() }
}

/// Where a picture stands in another.
fn find(big: &Picture, small: &Picture) -> Option<(u32, u32)> {
    let places = (0..=big.height - small.height).flat_map(|y| (0..=big.width - small.width).map(move |x| (x, y)));
    let line = small.width as usize * 3;
    let is_at = |x: u32, y: u32, row: u32| {
        let at = ((y + row) * big.width + x) as usize * 3;
        big.pixels[at..at + line] == small.pixels[row as usize * line..(row as usize + 1) * line]
    };
    // The middle row first: the upper ones are blank paper.
    let order = || (0..small.height).map(|r| (r + small.height / 2) % small.height);
    places.into_iter().find(|&(x, y)| order().all(|row| is_at(x, y, row)))
}

/// The views of a run's picture, without its lettering: bands of 9 px letters above and below.
fn views(path: &Path, count: u32, size: u32) -> Vec<Picture> {
    let whole = picture(path);
    (0..count).map(|i| crop(&whole, i * size, 38, size, size * 9 / 8)).collect()
}

#[test]
fn every_cell_is_what_a_run_draws() {
    let dir = folder(&[("style.lua", STYLE)]);
    let vary = ["--vary", "length=2..6:2", "--vary", "seed=0..1", "--set", "count=20"];
    let (code, _, err) =
        coif(dir.path(), &[&["sheet", "style.lua", "--size", "64", "--view", "left", "--fit"], &vary[..]].concat());
    assert_eq!(code, 0, "{err}");
    assert_eq!(names(&dir.path().join("out")), ["style.sheet.png"]);
    let sheet = picture(dir.path().join("out/style.sheet.png"));
    let mut places = vec![];
    for seed in ["0", "1"] {
        for length in ["length=2", "length=4", "length=6"] {
            let run = ["run", "style.lua", "--size", "64", "--views", "left", "--strands", "none", "-o", "one"];
            let set = ["--set", length, "--set", "count=20", "--seed", seed];
            let (code, _, err) = coif(dir.path(), &[&run[..], &set[..]].concat());
            assert_eq!(code, 0, "{err}");
            let alone = views(&dir.path().join("one/style.png"), 1, 64).remove(0);
            let (x, y) = find(&sheet, &alone).unwrap_or_else(|| panic!("{length} {seed} is not on the sheet"));
            places.push((y, x));
        }
    }
    // The first goes across, the second down.
    assert!(places.is_sorted() && places.windows(2).all(|w| w[0] != w[1]), "{places:?}");
    assert!(places[0].0 == places[2].0 && places[3].0 > places[2].0 && places[3].1 == places[0].1, "{places:?}");
}

#[test]
fn all_cells_share_one_scale_unless_they_are_fitted() {
    // Only a plate of skin grows: the head in every cell must be as large and in the same place.
    let style = r##"
local p = coif.params { length = 4 }
local head = coif.head()
local hair = head:scalp():guides { count = 3, length = p.length, step = 1 }:grow {}
return coif.scene { head, hair, views = { "front" } }
"##;
    let dir = folder(&[("style.lua", style)]);
    let sheet = |more: &[&str]| {
        let vary = ["sheet", "style.lua", "--size", "64", "--vary", "length=4,60"];
        let (code, _, err) = coif(dir.path(), &[&vary[..], more].concat());
        assert_eq!(code, 0, "{err}");
        picture(dir.path().join("out/style.sheet.png"))
    };
    // Pixels of skin in each half.
    let skin = |p: &Picture| {
        let mut count = [0_usize; 2];
        for (i, c) in p.pixels.chunks_exact(3).enumerate() {
            let half = usize::from(i as u32 % p.width >= p.width / 2);
            count[half] += usize::from(i32::from(c[0]) - i32::from(c[2]) > 15);
        }
        count
    };
    let ([a, b], [c, d]) = (skin(&sheet(&[])), skin(&sheet(&["--fit"])));
    assert!(a > 20 && a.abs_diff(b) * 5 < a, "one scale: {a} and {b} pixels of skin");
    assert!(c > 3 * d, "fitted: {c} and {d} pixels of skin");
}

#[test]
fn a_parameter_named_seed_is_not_guessed_at() {
    let style = "local p = coif.params { seed = 1 }\nreturn coif.scene { coif.head(), views = { 'front' } }";
    let test = "coif.test('a', function(t) local s = t:run 'style.lua' { seed = 2 }; t:equal(s.head.name, 'head') end)\n\
                coif.test('b', function(t) local s = t:run 'plain.lua' { width = 'x' }; t:equal(s.head.name, 'head') end)";
    let plain = "local p = coif.params { width = 1 }\nreturn coif.scene { coif.head() }";
    let dir = folder(&[("style.lua", style), ("plain.lua", plain), ("a_test.lua", test)]);
    let (code, _, err) = coif(dir.path(), &["sheet", "style.lua", "--vary", "seed=1..2"]);
    assert!(code == 1 && err.contains("`seed` is the seed of the run") && err.contains("another name"), "{err}");
    // Set by its own name it is the parameter, as `--seed` is the run's.
    let (code, out, err) = coif(dir.path(), &["params", "style.lua", "--set", "seed=7", "--seed", "3"]);
    assert!(code == 0 && out.starts_with("seed = 7"), "{out}{err}");
    let (code, _, err) = coif(dir.path(), &["test", "."]);
    assert!(code == 1 && err.contains("`seed` is the seed of the run"), "{err}");
    assert!(err.contains("`width` in the table of parameters") && !err.contains("--set"), "{err}");
}

#[test]
fn a_turntable_passes_the_four_sides() {
    let dir = folder(&[("style.lua", STYLE)]);
    let (code, _, err) = coif(dir.path(), &["sheet", "style.lua", "--size", "48", "--turntable", "4"]);
    assert_eq!(code, 0, "{err}");
    let sheet = picture(dir.path().join("out/style.sheet.png"));
    let run =
        ["run", "style.lua", "--size", "48", "--views", "front,left,back,right", "--strands", "none", "-o", "one"];
    assert_eq!(coif(dir.path(), &run).0, 0);
    // Four views make two rows of two, each with a caption of 18 px.
    let whole = picture(dir.path().join("one/style.png"));
    let places: Vec<(u32, u32)> = [(0, 38), (48, 38), (0, 38 + 72), (48, 38 + 72)]
        .iter()
        .map(|&(x, y)| find(&sheet, &crop(&whole, x, y, 48, 54)).expect("the view is on the sheet"))
        .collect();
    assert!(places.is_sorted() && places.iter().all(|p| p.1 == places[0].1), "{places:?}");
}

#[test]
fn variations_are_checked() {
    let dir = folder(&[("style.lua", STYLE)]);
    let said = |vary: &str| {
        let (code, _, err) = coif(dir.path(), &["sheet", "style.lua", "--size", "16", "--vary", vary]);
        (code, err)
    };
    // Told after the first of them, before the others are run.
    let (code, err) = said("count=10..210:100");
    assert!(code == 1 && err.contains("`--vary count`: `110` is out of range") && err.contains("`210`"), "{err}");
    assert!(!err.contains("2 of 3"), "{err}");
    let (code, err) = said("way=down,bakc");
    assert!(code == 1 && err.contains("did you mean \"back\"?"), "{err}");
    let (code, err) = said("lenght=2..3");
    assert!(code == 1 && err.contains("did you mean `length`?"), "{err}");
    for bad in ["length", "length=1..2:0", "length=1..a", "seed=a,b", "length=0..3000:0.1"] {
        assert_eq!(said(bad).0, 2, "{bad}");
    }
    assert_eq!(coif(dir.path(), &["sheet", "style.lua"]).0, 2);
    let twice = ["sheet", "style.lua", "--vary", "length=1..2", "--vary", "length=3..4"];
    assert_eq!(coif(dir.path(), &twice).0, 2);
    assert_eq!(names(dir.path()), ["style.lua"]);
    let (code, err) = said("way=down,back");
    assert_eq!(code, 0, "{err}");
}

#[test]
fn golden_pictures_are_kept_and_compared() {
    let dir = folder(&[("style.lua", STYLE), ("style_test.lua", TEST)]);
    let test = |more: &[&str]| coif(dir.path(), &[&["test", "."][..], more].concat());
    let golden = dir.path().join("golden/style.png");

    // Missing: a failure that says what to do, and the picture to look at.
    let (code, _, err) = test(&[]);
    assert!(code == 1 && err.contains("there is no golden picture `golden/style.png`"), "{err}");
    assert!(err.contains("--accept") && err.contains("style_test.lua:8:5"), "{err}");
    assert_eq!(names(&dir.path().join("out")), ["style.new.png"]);
    assert!(!golden.exists());

    // Accepting writes it and does not pass; the next run does.
    let (code, _, err) = test(&["--accept"]);
    assert!(code == 1 && err.contains("accepted") && err.contains("1 passed, 1 accepted"), "{err}");
    assert_eq!((picture(&golden).width, picture(&golden).height), (96, 54));
    let kept = std::fs::read(&golden).unwrap();
    for arguments in [&[][..], &["--accept"], &["--threads", "1"], &["--threads", "2"]] {
        let (code, _, err) = test(arguments);
        assert!(code == 0 && err.contains("2 tests: 2 passed"), "{arguments:?} {err}");
    }
    assert_eq!(std::fs::read(&golden).unwrap(), kept);

    // Another colour: the difference in three panels, whose first is the golden picture and third the new one.
    std::fs::write(dir.path().join("style.lua"), STYLE.replace("#503020", "#208050")).unwrap();
    let (code, _, err) = test(&["--junit", "reports/junit.xml"]);
    assert!(code == 1 && err.contains("`golden/style.png` differs in"), "{err}");
    let panels = picture(dir.path().join("out/style.diff.png"));
    let new = picture(dir.path().join("out/style.new.png"));
    assert_eq!(crop(&panels, 0, 0, 96, 54), new, "the picture that was kept");
    let red = crop(&panels, 96, 0, 96, 54).pixels.chunks(3).filter(|p| *p == [230, 20, 40]).count();
    assert!(red > 50, "{red}");
    assert_ne!(crop(&panels, 192, 0, 96, 54), new);
    assert_eq!(std::fs::read(&golden).unwrap(), kept, "nothing was accepted");
    let xml = std::fs::read_to_string(dir.path().join("reports/junit.xml")).unwrap();
    assert!(xml.contains("tests=\"2\" failures=\"1\"") && xml.contains("name=\"picture\""), "{xml}");
    assert!(xml.contains("<failure type=\"failure\" message=\"`golden/style.png` differs in"), "{xml}");
    assert_eq!((xml.matches("<testcase").count(), xml.matches("</testsuites>").count()), (2, 1));

    // A golden picture that nobody asks for is told, unless tests were left out.
    std::fs::write(dir.path().join("style.lua"), STYLE).unwrap();
    std::fs::copy(&golden, dir.path().join("golden/old.png")).unwrap();
    let (code, _, err) = test(&[]);
    assert!(code == 1 && err.contains("golden/old.png: no test refers to"), "{err}");
    let (code, _, err) = test(&["--filter", "figures"]);
    assert!(code == 0 && err.contains("1 passed, 1 left out"), "{err}");
    assert_eq!(test(&["--filter", "nothing of the kind"]).0, 1);

    // A broken one is a failure like any other.
    std::fs::remove_file(dir.path().join("golden/old.png")).unwrap();
    std::fs::write(&golden, &kept[..kept.len() / 2]).unwrap();
    let (code, _, err) = test(&[]);
    assert!(code == 1 && err.contains("is no PNG picture"), "{err}");

    // Two tests cannot keep one picture.
    std::fs::write(&golden, &kept).unwrap();
    std::fs::write(dir.path().join("style_test.lua"), format!("{TEST}{}", TEST.replace("test(\"", "test(\"again ")))
        .unwrap();
    let (code, _, err) = test(&[]);
    assert!(code == 1 && err.contains("another test at style_test.lua:8 has a preview `style` too"), "{err}");
    assert!(err.contains("3 passed, 1 failed"), "{err}");
}

#[test]
fn several_failures_are_told_each_in_its_place() {
    let tests = r#"
local function twice(t, n)
  return t:equal(n, 2)
end
coif.test("many", function(t)
  t:equal(1, 2)
  t:near(1, 1.2, 0.1)
  t:near({ 0, 0, 0 }, vector.create(0, 3, 4), 5)
  twice(t, 3)
  t:less(2, 2)
  t:between(5, 1, 4)
  t:ok(nil, "there must be something")
  t:equal({ a = { 1, 2 } }, { a = { 1, 3 } })
  t:error(function() end, "x")
  t:error(function() error("apples") end, "pears")
  t:error(function() error("apples") end, "apples")
  t:require(t:greater(1, 2))
  t:ok(false, "not reached")
end)
coif.test("broken", function(t)
  local nothing = nil
  return nothing.x
end)
coif.test("fine", function(t)
  local mine = t:require(t:scene(coif.scene { coif.head() }))
  t:greater(mine.head:stats().triangles, 1000)
  t:error(function() return mine.hair end, "no `hair`")
  t:error(function() return mine.head:stats().strands end, "no `strands`")
end)
coif.test("endless", function(t)
  while true do pcall(t.ok, t, true) end
end)
coif.test("last", function(t) t:ok(true) end)
"#;
    let dir = folder(&[("a_test.lua", tests), ("b_test.lua", "coif.tset('x', print)"), ("c_test.lua", "local x = 1")]);
    let (code, _, err) = coif(dir.path(), &["test", ".", "--time-limit", "3"]);
    assert_eq!(code, 1, "{err}");
    let expected = [
        ("expected `2`, got `1`", "a_test.lua:6:5"),
        ("expected `1.2` to within 0.1, got `1`, which is 0.2 off", "a_test.lua:7:5"),
        ("expected `2`, got `3`", "a_test.lua:3:12"),
        ("expected less than `2`, got `2`", "a_test.lua:10:5"),
        ("expected `1` to `4`, got `5`", "a_test.lua:11:5"),
        ("there must be something", "a_test.lua:12:5"),
        ("expected `3` at `a[2]`, got `2`", "a_test.lua:13:5"),
        ("expected an error, but the function returned `nil`", "a_test.lua:14:5"),
        ("expected an error that says `pears`, got `apples`", "a_test.lua:15:5"),
        ("expected more than `2`, got `1`", "a_test.lua:17:"),
        ("attempt to index nil with 'x'", "a_test.lua:22:"),
        ("`a_test.lua` ran longer than 3 s", ""),
        ("`coif` has no `tset`", "b_test.lua:1:6"),
        ("`c_test.lua` has no test", ""),
    ];
    let mut rest = err.as_str();
    for (message, place) in expected {
        let at = rest.find(message).unwrap_or_else(|| panic!("`{message}` is missing, or out of order, in\n{err}"));
        rest = &rest[at..];
        assert!(rest.contains(place), "{message} {place}\n{err}");
    }
    assert_eq!(err.matches("error: ").count(), expected.len(), "{err}");
    assert!(err.contains("a_test.lua:9 in") && !err.contains("not reached"), "{err}");
    for passed in ["fine", "last"] {
        assert!(err.contains(&format!("passed  a_test.lua: {passed}")), "{err}");
    }
    assert!(err.contains("7 tests: 2 passed, 5 failed"), "{err}");
}

#[test]
fn tests_are_there_for_tests_only_and_stay_in_their_folder() {
    let dir = folder(&[("style.lua", TEST)]);
    let (code, _, err) = coif(dir.path(), &["run", "style.lua"]);
    assert!(code == 1 && err.contains("`coif` has no `test`"), "{err}");
    std::fs::create_dir(dir.path().join("inner")).unwrap();
    std::fs::write(dir.path().join("secret.lua"), "secret").unwrap();
    let tests = r#"
coif.test("a", function(t) t:run "../secret.lua" end)
coif.test("a", function(t) end)"#;
    std::fs::write(dir.path().join("inner/x_test.lua"), tests).unwrap();
    let (code, _, err) = coif(dir.path(), &["test", "inner"]);
    assert!(code == 1 && err.contains("there is already a test `a`"), "{err}");
    std::fs::write(dir.path().join("inner/x_test.lua"), tests.lines().nth(1).unwrap()).unwrap();
    // From above the style is below the current folder; from within the folder it is not.
    let (code, _, err) = coif(dir.path(), &["test", "inner"]);
    assert!(code == 0, "{err}");
    let (code, _, err) = coif(&dir.path().join("inner"), &["test", "x_test.lua"]);
    assert!(code == 1 && err.contains("lies outside") && err.contains("--allow"), "{err}");
    let (code, _, err) = coif(&dir.path().join("inner"), &["test", "x_test.lua", "--allow", ".."]);
    assert!(code == 0, "{err}");
    assert_eq!(coif(dir.path(), &["test", "nowhere"]).0, 1);
    assert_eq!(coif(dir.path(), &["test", "style.lua", "--accpet"]).0, 2);
}

#[test]
fn locks_are_compared_too() {
    let bob = include_str!("../examples/cartoon/bob.lua");
    let longer = bob.replace("length = { 1,", "length = { 1.3,");
    let red = bob.replace("#7b3f8c", "#c02020");
    assert!(longer != bob && red != bob);
    let dir = folder(&[("a.lua", bob), ("longer.lua", &longer), ("red.lua", &red)]);
    let changed = |b: &str| {
        let (code, out, err) = coif(dir.path(), &["diff", "a.lua", b, "--json", "--size", "48"]);
        assert_eq!(code, 0, "{err}");
        serde_json::from_str::<serde_json::Value>(&out).unwrap()
    };
    let sum = |v: &serde_json::Value, what: &str| -> u64 {
        v["parts"].as_array().unwrap().iter().map(|p| p[what].as_u64().unwrap()).sum()
    };
    let longer = changed("longer.lua");
    // The bob's locks move, the fringe stays.
    assert!(sum(&longer, "moved") > 0 && sum(&longer, "moved") < sum(&longer, "locks_after"), "{longer}");
    assert_eq!((sum(&longer, "added"), sum(&longer, "removed")), (0, 0), "{longer}");
    let red = changed("red.lua");
    assert_eq!(sum(&red, "moved") + sum(&red, "added") + sum(&red, "removed"), 0, "{red}");
    let looks = |p: &serde_json::Value| p["material"].as_array().unwrap().iter().any(|c| c["after"] == "#c02020");
    assert!(red["parts"].as_array().unwrap().iter().any(looks), "{red}");
    assert_eq!(changed("a.lua")["same"], true);
}

#[test]
fn comparisons_tell_what_changed() {
    let more = STYLE.replace("strands = 120", "strands = 150");
    let longer = STYLE.replace("length = { 4,", "length = { 6,").replace("width = 0.2", "width = 0.3");
    let dir = folder(&[("a.lua", STYLE), ("same.lua", STYLE), ("more.lua", &more), ("longer.lua", &longer)]);
    let json = |b: &str| {
        let (code, out, err) = coif(dir.path(), &["diff", "a.lua", b, "--json", "--each", "--size", "48"]);
        assert_eq!(code, 0, "{err}");
        serde_json::from_str::<serde_json::Value>(&out).unwrap()
    };
    let same = json("same.lua");
    assert_eq!(same["same"], true, "{same}");
    assert_eq!(coif(dir.path(), &["diff", "a.lua", "same.lua", "--no-picture"]).1, "nothing changed\n");

    // A higher density only adds.
    let more = json("more.lua");
    let hair = &more["parts"][1];
    assert_eq!((&hair["added"], &hair["removed"], &hair["moved"]), (&30.into(), &0.into(), &0.into()), "{more}");
    assert_eq!(more["parts"][0]["state"], "same");
    let each = hair["strands"].as_array().unwrap();
    assert!(each.len() == 30 && each.iter().all(|s| s["what"] == "added" && s["id"].as_str().unwrap().len() == 16));

    let longer = json("longer.lua");
    assert_eq!(longer["parameters"][0]["what"], "default of length", "{longer}");
    assert_eq!((&longer["parameters"][0]["before"], &longer["parameters"][0]["after"]), (&"4".into(), &"6".into()));
    let hair = &longer["parts"][1];
    assert_eq!((&hair["moved"], &hair["material"][0]["what"]), (&120.into(), &"width".into()), "{longer}");
    // Two centimetres more cannot move a node by more than its share and what the noise makes of it.
    let most = hair["max_distance"].as_f64().unwrap();
    assert!(most > 1.0 && most < 8.0 && hair["mean_distance"].as_f64().unwrap() < most, "{longer}");
    assert_eq!(names(&dir.path().join("out")), ["a_longer.diff.png", "a_more.diff.png", "a_same.diff.png"]);

    // Of equal styles the outer panels are equal; the middle one is another picture.
    let sheet = picture(dir.path().join("out/a_same.diff.png"));
    let panel = |k: u32| crop(&sheet, 4 + k * 52, 38, 48, 54);
    assert_eq!(panel(0), panel(2));
    assert_ne!(panel(0), panel(1));

    let (code, _, err) = coif(dir.path(), &["diff", "a.lua", "b.lua"]);
    assert!(code == 1 && err.contains("there is no file `b.lua`"), "{err}");
}
