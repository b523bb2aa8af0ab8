//! Provenance of a measurement: program, date and machine.

use std::time::SystemTime;

use kinopt_harness::{Machine, Provenance};

pub(super) fn provenance() -> Provenance {
    let typed: Vec<String> = std::env::args().skip(1).map(|word| quoted(&word)).collect();
    Provenance {
        tool: format!("kinopt {}", env!("CARGO_PKG_VERSION")),
        date: humantime::format_rfc3339_seconds(SystemTime::now()).to_string(),
        machine: Machine {
            cpu: cpu(),
            cores: std::thread::available_parallelism().map_or(0, usize::from),
        },
        command: format!("kinopt {}", typed.join(" ")),
    }
}

/// Word quoted for a shell.
fn quoted(word: &str) -> String {
    match word.contains([' ', '\'', '"', '$', '*']) {
        true => format!("'{}'", word.replace('\'', r"'\''")),
        false => word.to_owned(),
    }
}

/// Name of the processor on Linux, elsewhere its architecture.
fn cpu() -> String {
    let text = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let mut lines = text.lines().filter_map(|line| line.split_once(':'));
    let name = lines.find(|(key, _)| key.trim() == "model name");
    name.map_or(std::env::consts::ARCH, |(_, name)| name.trim())
        .to_owned()
}
