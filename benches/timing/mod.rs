//! What the benches of reloading have in common: where the time of a run went.

use std::path::Path;
use std::time::Duration;

use coif::script::Origin;
use coif::workbench::Report;

/// Where the time went.
pub fn tell(report: &Report) {
    let mark = |origin: Option<Origin>| origin.map_or(String::new(), |o| format!(" {}", o.text()));
    let calls = report.outcome.timings.iter().map(|t| format!("{} {}{}", t.what, ms(t.time), mark(t.origin)));
    let stages = report.stages.iter().map(|s| format!("{} {}{}", s.what, ms(s.time), mark(s.origin)));
    println!("    {}", stages.chain(calls).collect::<Vec<_>>().join(", "));
}

/// Milliseconds, for people.
pub fn ms(time: Duration) -> String {
    format!("{:.1} ms", time.as_secs_f64() * 1e3)
}

/// Processor time of this process so far, in hundredths of a second; zero where the system does not tell it.
pub fn processor_time() -> Duration {
    let text = std::fs::read_to_string(Path::new("/proc/self/stat")).unwrap_or_default();
    // The second field is a name in brackets, which may contain anything; user and system time are the 14th and 15th.
    let after = text.rsplit(')').next().unwrap_or_default();
    let ticks: u64 = after.split_whitespace().skip(11).take(2).filter_map(|n| n.parse::<u64>().ok()).sum();
    Duration::from_millis(ticks * 10)
}
