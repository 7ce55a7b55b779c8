//! Memory of this process and of the machine, where the system tells (Linux).

/// Largest resident memory of this process so far (bytes), or 0 where the system does not tell.
pub fn peak_bytes() -> usize {
    entry("/proc/self/status", "VmHWM:").unwrap_or(0)
}

/// Resident memory of this process (bytes), or 0 where the system does not tell.
pub fn used_bytes() -> usize {
    entry("/proc/self/status", "VmRSS:").unwrap_or(0)
}

/// Memory that the machine can still give without swapping (bytes).
pub fn available_bytes() -> Option<usize> {
    entry("/proc/meminfo", "MemAvailable:")
}

/// Memory of the machine (bytes).
pub fn total_bytes() -> Option<usize> {
    entry("/proc/meminfo", "MemTotal:")
}

fn entry(file: &str, key: &str) -> Option<usize> {
    let text = std::fs::read_to_string(file).ok()?;
    let line = text.lines().find_map(|line| line.strip_prefix(key))?;
    let kilobytes: usize = line.trim().trim_end_matches("kB").trim().parse().ok()?;
    Some(1024 * kilobytes)
}
