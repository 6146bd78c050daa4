//! The host against scripts that mean no good, and the promises of determinism.

use std::collections::BTreeMap;
use std::sync::Arc;
use std::time::{Duration, Instant};

use super::{Ending, Memory, Options, Outcome, Severity, run};
use crate::params::Value;
use crate::task::Task;

fn options(limit: f64) -> Options {
    Options { time_limit: Duration::from_secs_f64(limit), ..Options::new("style/a.lua") }
}

fn script(text: &str, options: &Options) -> Outcome {
    let files = Memory::default().with("style/a.lua", text).with("secret.lua", "return 'secret'");
    run(options, Arc::new(files), &Task::new())
}

/// The first error, as one line.
fn error(text: &str) -> String {
    let outcome = script(text, &options(20.0));
    assert_eq!(outcome.ending, Ending::Failed, "{text}");
    outcome.diagnostics.first().map(ToString::to_string).unwrap_or_default()
}

/// What a script prints.
fn log(text: &str) -> Vec<String> {
    let outcome = script(&format!("{text}\nreturn coif.scene {{ }}"), &options(20.0));
    assert_eq!(outcome.ending, Ending::Done, "{text}: {:?}", outcome.diagnostics);
    outcome.log
}

#[test]
fn endless_scripts_are_stopped() {
    let endless = [
        "while true do end",
        "repeat until false",
        "local function f() return f() end f()",
        "while true do pcall(function() while true do end end) end",
        "while true do pcall(error) end",
        "local function f() while true do pcall(f) end end f()",
        "xpcall(function() error('x') end, function() while true do end end)",
        "xpcall(function() while true do end end, function() while true do end end)",
        "coroutine.wrap(function() while true do end end)()",
        "local c = coroutine.create(function() while true do coroutine.yield() end end) while true do coroutine.resume(c) end",
        "string.find(('a'):rep(1000), ('.-'):rep(12) .. 'b')",
        "local t = setmetatable({}, { __index = function(t, k) return t[k] end }) pcall(function() return t.x end) while true do end",
        "setmetatable({}, { __tostring = function() while true do end end }); print(setmetatable({}, { __tostring = function() while true do end end }))",
        "error(setmetatable({}, { __tostring = function() while true do end end }))",
        "table.sort({ 3, 1, 2, 5, 4 }, function(a, b) while true do end end)",
        "('x'):gsub('x', function() while true do end end)",
        "for i = 1, math.huge do end",
    ];
    for text in endless {
        let started = Instant::now();
        let outcome = script(text, &options(0.2));
        let message = outcome.diagnostics.first().map(|d| d.message.clone()).unwrap_or_default();
        assert_eq!(outcome.ending, Ending::Failed, "{text}");
        // A few of them end in an error of their own before the time is over.
        assert!(
            message.contains("ran longer than 0.2 s")
                || message.contains("overflow")
                || message.contains("the script raised"),
            "{text}: {message}"
        );
        // Not a measurement: it would hang for ever.
        assert!(started.elapsed() < Duration::from_secs(20), "{text}");
    }
}

#[test]
fn memory_is_bounded() {
    for text in [
        "local s = 'a' while true do s = s .. s end",
        "local t = {} for i = 1, 1e12 do t[i] = { i } end",
        "local t = table.create(1e9, 1)",
        "local b = {} for i = 1, 1e6 do b[i] = buffer.create(1e8) end",
        "local s = ('x'):rep(1e8) local t = {} for i = 1, 1000 do t[i] = s .. i end",
    ] {
        let message = error(text);
        assert!(
            message.contains("not enough memory") || message.contains("too large") || message.contains("overflow"),
            "{text}: {message}"
        );
    }
}

#[test]
fn there_are_no_doors() {
    for name in [
        "io",
        "os",
        "debug",
        "loadstring",
        "load",
        "dofile",
        "loadfile",
        "getfenv",
        "setfenv",
        "newproxy",
        "collectgarbage",
        "gcinfo",
        "package",
        "jit",
        "ffi",
    ] {
        let message = error(&format!("return {name}"));
        assert!(message.contains("does not exist here") || message.contains("unknown name"), "{name}: {message}");
        assert_eq!(log(&format!("print(rawget(_G, '{name}'))")), ["nil"], "{name}");
    }
    for text in [
        "string.format = nil",
        "math.pi = 3",
        "coif.params = print",
        "getmetatable('').__index = {}",
        "setmetatable(coif, {})",
        "rawset(coif, 'x', 1)",
        "rawset(math, 'pi', 3)",
        "table.insert(coif, 1)",
        "_G.print = nil",
        "require '../secret'",
        "require '/etc/passwd'",
        "require 'coif/../../secret'",
        "require '\\0'",
        "require(string.rep('x', 10000))",
        "require 'a'",
    ] {
        assert!(!error(text).is_empty(), "{text}");
    }
    // Bytecode is not text, and no text of ours.
    let outcome = run(
        &options(5.0),
        Arc::new(Memory::default().with("style/a.lua", b"\x06\x03\x01\x02\xff".to_vec())),
        &Task::new(),
    );
    assert_eq!(outcome.ending, Ending::Failed);
    let outcome =
        run(&options(5.0), Arc::new(Memory::default().with("style/a.lua", b"\x05\x03\x01\x02".to_vec())), &Task::new());
    assert_eq!(outcome.ending, Ending::Failed);
}

#[test]
fn a_cancelled_run_says_nothing() {
    let task = Task::new();
    task.cancel();
    let outcome = run(&options(5.0), Arc::new(Memory::default().with("style/a.lua", "while true do end")), &task);
    assert_eq!((outcome.ending, outcome.diagnostics.len()), (Ending::Cancelled, 0));
}

#[test]
fn randomness_follows_the_seed_alone() {
    let text = "print(math.random(), math.random(10), math.random(-5, 5)) for i = 1, 50 do local n = math.random(3) assert(n >= 1 and n <= 3 and n % 1 == 0) end print(coif.seed)";
    let with = |seed: u64| script(&format!("{text} return coif.scene {{}}"), &Options { seed, ..options(20.0) }).log;
    assert_eq!(with(1), with(1));
    assert_ne!(with(1)[0], with(2)[0]);
    assert_eq!(with(2)[1], "2");
    assert!(error("math.random(3, 1)").contains("empty"));
    assert_eq!(
        log("math.randomseed(7) local a = math.random() math.randomseed(7) print(a == math.random())"),
        ["true"]
    );
}

#[test]
fn printing_goes_to_the_log_and_is_bounded() {
    assert_eq!(
        log("print('a', 1, nil, true) print(vector.create(1, 2, 3), coif.up)"),
        ["a\t1\tnil\ttrue", "vector(1, 2, 3)\tvector(0, 1, 0)"]
    );
    let lines = log("for i = 1, 1e5 do print(('x'):rep(100)) end");
    assert!(lines.len() < 20_000 && lines.last().is_some_and(|l| l.contains("left out")));
    assert_eq!(log("print(coif.material.hair {})"), ["<hair material #2e1b12 to #6b432b>"]);
}

#[test]
fn modules_are_loaded_once_and_recorded() {
    let files = Memory::default()
        .with("style/a.lua", "local b = require 'lib/b' local c = require './lib/c' assert(require 'lib/b' == b) print(b.n, c) return coif.scene {}")
        .with("style/lib/b.lua", "print 'once' return { n = 1, c = require './c' }")
        .with("style/lib/c.lua", "return 'c'");
    let outcome = run(&options(5.0), Arc::new(files), &Task::new());
    assert_eq!(outcome.log, ["once", "1\tc"], "{:?}", outcome.diagnostics);
    let asked: Vec<String> = outcome.dependencies.iter().map(|p| p.display().to_string()).collect();
    assert_eq!(asked, ["style/a.lua", "style/lib/b.lua", "style/lib/c.lua"]);
    let circle = Memory::default()
        .with("style/a.lua", "require 'b'")
        .with("style/b.lua", "local ok = pcall(require, 'c') assert(not ok) require 'c'")
        .with("style/c.lua", "return require 'b'");
    let outcome = run(&options(5.0), Arc::new(circle), &Task::new());
    assert_eq!(outcome.diagnostics[0].to_string(), "style/c.lua:1:16: error: `b` requires itself in a circle");
    assert_eq!(outcome.diagnostics[0].trace.len(), 2);
    assert!(error("require 'b'").contains("there is no module `b`"));
}

#[test]
fn every_script_of_the_library_loads() {
    for (name, _) in super::module::LIBRARY {
        log(&format!("assert(require '{name}')"));
    }
}

#[test]
fn parameters_are_declared_and_set() {
    let text =
        "local p = coif.params { n = { 3, min = 1, max = 5, integer = true, unit = 'cm', doc = 'how many' }, on = true,
        c = '#ffffff', way = { 'up', choices = { 'up', 'down' } }, at = { { 0, 1, 2 } } }
        print(p.n, p.on, p.c, p.way, p.at.z)  return coif.scene {}";
    let with = |set: &[(&str, &str)]| {
        let set: BTreeMap<String, String> = set.iter().map(|&(k, v)| (k.into(), v.into())).collect();
        script(text, &Options { set, ..options(20.0) })
    };
    assert_eq!(with(&[]).log, ["3\ttrue\t#ffffff\tup\t2"]);
    let set = with(&[("n", "5"), ("on", "false"), ("c", "#000000"), ("way", "down"), ("at", "1, 2, 3.5")]);
    assert_eq!(set.log, ["5\tfalse\t#000000\tdown\t3.5"]);
    assert_eq!(set.parameters.len(), 5);
    assert!(matches!(set.parameters.iter().find(|p| p.name == "n").map(|p| &p.default), Some(Value::Number(3.0))));
    for bad in [
        ("n", "6"),
        ("n", "2.5"),
        ("n", "x"),
        ("n", "nan"),
        ("on", "yes"),
        ("c", "red"),
        ("way", "left"),
        ("at", "1,2"),
        ("m", "1"),
    ] {
        let outcome = with(&[bad]);
        assert_eq!(outcome.ending, Ending::Failed, "{bad:?}");
        assert_eq!(outcome.diagnostics[0].severity, Severity::Error);
        assert!(outcome.diagnostics[0].message.contains(bad.0), "{bad:?}: {}", outcome.diagnostics[0]);
    }
}

#[test]
fn a_caught_error_does_not_fail_the_run() {
    assert_eq!(
        log("local ok, e = pcall(coif.material.hair, { shine = 3 }) print(ok, (tostring(e):gsub('\\n.*', '')))"),
        ["false\tstyle/a.lua:1:39: error: `3` is out of range"]
    );
}
