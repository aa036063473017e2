//! What a run costs: seconds per stage, peak memory.

use std::time::Instant;

/// Adds up wall time per stage, in the order in which the stages first ran.
#[derive(Debug, Clone, Default, bevy::prelude::Resource)]
pub struct Stopwatch {
    stages: Vec<(&'static str, f64)>,
}

impl Stopwatch {
    /// Runs `work` and adds its time to `stage`.
    pub fn time<T>(&mut self, stage: &'static str, work: impl FnOnce() -> T) -> T {
        let start = Instant::now();
        let result = work();
        self.add(stage, start.elapsed().as_secs_f64());
        result
    }

    /// Adds seconds to a stage.
    pub fn add(&mut self, stage: &'static str, seconds: f64) {
        match self.stages.iter_mut().find(|(name, _)| *name == stage) {
            Some((_, total)) => *total += seconds,
            None => self.stages.push((stage, seconds)),
        }
    }

    /// Seconds per stage so far.
    pub fn seconds(&self) -> Vec<(&'static str, f64)> {
        self.stages.clone()
    }
}

/// The most memory this process has held, in bytes; `None` where the system does not tell.
pub fn peak_memory_bytes() -> Option<u64> {
    peak_of_status(&std::fs::read_to_string("/proc/self/status").ok()?)
}

/// `VmHWM:     1234 kB` in Linux' `/proc/self/status`, where kB means 1024 bytes.
fn peak_of_status(status: &str) -> Option<u64> {
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    let kibibytes: u64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    Some(kibibytes * 1024)
}

/// Bytes as people say them: `640 MB`, `1.2 GB`.
pub fn human_bytes(bytes: f64) -> String {
    let units = ["B", "kB", "MB", "GB", "TB", "PB", "EB"];
    let mut value = bytes;
    let mut unit = 0;
    while value >= 1000.0 && unit + 1 < units.len() {
        value /= 1000.0;
        unit += 1;
    }
    if value < 10.0 && unit > 0 { format!("{value:.1} {}", units[unit]) } else { format!("{value:.0} {}", units[unit]) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stages_add_up_in_order() {
        let mut watch = Stopwatch::default();
        watch.add("voxel", 1.0);
        watch.add("edge", 2.0);
        watch.add("voxel", 0.5);
        assert_eq!(watch.seconds(), [("voxel", 1.5), ("edge", 2.0)]);
        assert_eq!(watch.time("edge", || 7), 7);
        assert!(watch.seconds()[1].1 >= 2.0);
    }

    #[test]
    fn reads_the_peak() {
        assert_eq!(peak_of_status("VmPeak:\t 9 kB\nVmHWM:\t    12 kB\n"), Some(12288));
        assert_eq!(peak_of_status("VmPeak:\t 9 kB\n"), None);
    }

    #[test]
    fn says_bytes() {
        assert_eq!(human_bytes(12.0), "12 B");
        assert_eq!(human_bytes(1.25e9), "1.2 GB");
        assert_eq!(human_bytes(4e17), "400 PB");
    }
}
