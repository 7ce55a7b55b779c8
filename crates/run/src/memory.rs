//! Memory of this process and of the machine, where the system tells (Linux).

use std::path::{Path, PathBuf};

/// Largest resident memory of this process so far (bytes), or 0 where the system does not tell.
pub fn peak_bytes() -> usize {
    System::this()
        .entry("proc/self/status", "VmHWM:")
        .unwrap_or(0)
}

/// Resident memory of this process (bytes), or 0 where the system does not tell.
pub fn used_bytes() -> usize {
    System::this()
        .entry("proc/self/status", "VmRSS:")
        .unwrap_or(0)
}

/// Memory that this process can still have (bytes): what the machine gives without swapping, the
/// limit of its control groups (of a container, a batch job), that of its address space
/// (`ulimit -v`) and what the system promises (`vm.overcommit_memory = 2`) allow.
pub fn available_bytes() -> Option<usize> {
    System::this().available()
}

/// What a limit of the address space (`ulimit -v`) leaves this process (bytes); none without one.
pub fn address_space_left() -> Option<usize> {
    System::this().left_of_address_space()
}

/// Whether the system promises no more memory than it has (`vm.overcommit_memory = 2`), and so may
/// refuse any.
pub fn is_promised_strictly() -> bool {
    System::this().is_strict()
}

/// Memory of the machine (bytes).
pub fn total_bytes() -> Option<usize> {
    System::this().entry("proc/meminfo", "MemTotal:")
}

/// Dense kernels reserve this multiple of the largest cache as address space, and use little of it.
const KERNEL_CACHES: usize = 2;

/// The files in which the system tells.
struct System {
    root: PathBuf,
}

impl System {
    fn this() -> Self {
        Self { root: "/".into() }
    }

    fn read(&self, file: impl AsRef<Path>) -> Option<String> {
        std::fs::read_to_string(self.root.join(file)).ok()
    }

    /// A number that stands alone in a file, with `K` for kilobytes; none if it is no number, as
    /// the `max` of a control group without a limit.
    fn number(&self, file: impl AsRef<Path>) -> Option<usize> {
        let text = self.read(file)?;
        match text.trim().strip_suffix('K') {
            Some(kilobytes) => Some(1024 * kilobytes.parse::<usize>().ok()?),
            None => text.trim().parse().ok(),
        }
    }

    /// A number of kilobytes behind a key, in bytes.
    fn entry(&self, file: &str, key: &str) -> Option<usize> {
        let text = self.read(file)?;
        let line = text.lines().find_map(|line| line.strip_prefix(key))?;
        let kilobytes: usize = line.trim().trim_end_matches("kB").trim().parse().ok()?;
        Some(1024 * kilobytes)
    }

    fn available(&self) -> Option<usize> {
        let machine = self.entry("proc/meminfo", "MemAvailable:");
        let reserved = [self.left_of_address_space(), self.left_of_promises()];
        let beside_kernels = reserved.map(|left| Some(left?.saturating_sub(self.kernels())));
        let limits = [machine].into_iter().chain(beside_kernels);
        let groups = self.left_of_groups();
        limits.flatten().chain(groups).min()
    }

    /// What the limit of the address space leaves.
    fn left_of_address_space(&self) -> Option<usize> {
        let limits = self.read("proc/self/limits")?;
        let line = limits
            .lines()
            .find_map(|line| line.strip_prefix("Max address space"))?;
        let limit: usize = line.split_whitespace().next()?.parse().ok()?;
        let used = self.entry("proc/self/status", "VmSize:").unwrap_or(0);
        Some(limit.saturating_sub(used))
    }

    fn is_strict(&self) -> bool {
        const STRICT: usize = 2;
        self.number("proc/sys/vm/overcommit_memory") == Some(STRICT)
    }

    /// What a system that promises no more memory than it has still promises.
    fn left_of_promises(&self) -> Option<usize> {
        self.is_strict().then_some(())?;
        let promised = self.entry("proc/meminfo", "Committed_AS:")?;
        let limit = self.entry("proc/meminfo", "CommitLimit:")?;
        Some(limit.saturating_sub(promised))
    }

    /// Address space that dense kernels reserve.
    fn kernels(&self) -> usize {
        let caches = (0..4).filter_map(|index| {
            let cache = format!("sys/devices/system/cpu/cpu0/cache/index{index}/size");
            self.number(cache)
        });
        KERNEL_CACHES * caches.max().unwrap_or(0)
    }

    /// What each control group that this process belongs to leaves, of both versions.
    fn left_of_groups(&self) -> Vec<usize> {
        let groups = self.read("proc/self/cgroup").unwrap_or_default();
        let mut left = Vec::new();
        for line in groups.lines() {
            let mut parts = line.splitn(3, ':').skip(1);
            let (Some(controllers), Some(path)) = (parts.next(), parts.next()) else {
                continue;
            };
            let of = match controllers {
                "" => [
                    "sys/fs/cgroup",
                    "memory.max",
                    "memory.current",
                    "inactive_file ",
                ],
                _ if controllers.split(',').any(|name| name == "memory") => [
                    "sys/fs/cgroup/memory",
                    "memory.limit_in_bytes",
                    "memory.usage_in_bytes",
                    "total_inactive_file ",
                ],
                _ => continue,
            };
            // A container may see its group under another path, so the root counts as well.
            for group in Path::new(path.trim_start_matches('/')).ancestors() {
                left.extend(self.left_of_group(&Path::new(of[0]).join(group), of));
            }
        }
        left
    }

    fn left_of_group(&self, group: &Path, [_, limit, used, cached]: [&str; 4]) -> Option<usize> {
        let limit = self.number(group.join(limit))?;
        let used = self.number(group.join(used)).unwrap_or(0);
        // Files that were read are given up first.
        let statistics = self.read(group.join("memory.stat")).unwrap_or_default();
        let cached = statistics
            .lines()
            .find_map(|line| line.strip_prefix(cached));
        let cached = cached.and_then(|text| text.trim().parse::<usize>().ok());
        Some(limit.saturating_sub(used.saturating_sub(cached.unwrap_or(0))))
    }
}

/// A memory in words.
pub fn in_words(bytes: usize) -> String {
    match bytes {
        ..10_000_000 => format!("{:.1} MB", bytes as f64 / 1e6),
        10_000_000..100_000_000 => format!("{:.0} MB", bytes as f64 / 1e6),
        _ => format!("{:.2} GB", bytes as f64 / 1e9),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const GIB: usize = 1 << 30;

    #[test]
    fn memories_are_told_in_units_that_leave_digits() {
        let told = [640_000, 57_600_000, 1_250_000_000].map(in_words);
        assert_eq!(told, ["0.6 MB", "58 MB", "1.25 GB"]);
    }

    /// A system that tells this, on a machine that has 8 GiB left.
    fn available(files: &[(&str, &str)]) -> Option<usize> {
        let root = tempfile::tempdir().expect("a folder");
        let meminfo = (
            "proc/meminfo",
            "MemTotal: 9 kB\nMemAvailable:    8388608 kB\nCommitLimit:     6291456 kB\n\
             Committed_AS:    1048576 kB\n",
        );
        for (file, text) in [meminfo].iter().chain(files) {
            let path = root.path().join(file);
            std::fs::create_dir_all(path.parent().expect("a folder")).expect("made");
            std::fs::write(path, text).expect("written");
        }
        let root = root.path().to_owned();
        System { root }.available()
    }

    fn limits(limit: &str) -> String {
        let head = "Limit                     Soft Limit           Hard Limit           Units\n";
        format!("{head}Max address space         {limit}             unlimited            bytes\n")
    }

    #[test]
    fn the_machine_is_the_limit_where_nothing_else_is() {
        assert_eq!(available(&[]), Some(8 * GIB));
        let unlimited = limits("unlimited");
        let files = [
            ("proc/self/limits", &unlimited[..]),
            ("proc/self/cgroup", "5:devices:/\n0::/job\n"),
            ("sys/fs/cgroup/job/memory.max", "max\n"),
        ];
        assert_eq!(available(&files), Some(8 * GIB));
    }

    #[test]
    fn the_address_space_counts_without_what_is_taken_and_reserved() {
        let limit = limits("4294967296");
        let mut files = vec![
            ("proc/self/limits", &limit[..]),
            (
                "proc/self/status",
                "VmPeak: 7 kB\nVmSize:   1048576 kB\nVmRSS: 12 kB\n",
            ),
        ];
        assert_eq!(available(&files), Some(3 * GIB));
        files.push(("sys/devices/system/cpu/cpu0/cache/index0/size", "48K\n"));
        files.push(("sys/devices/system/cpu/cpu0/cache/index3/size", "262144K\n"));
        assert_eq!(available(&files), Some(3 * GIB - GIB / 2));
    }

    #[test]
    fn what_a_strict_system_has_promised_counts() {
        let file = "proc/sys/vm/overcommit_memory";
        assert_eq!(available(&[(file, "0\n")]), Some(8 * GIB));
        assert_eq!(available(&[(file, "2\n")]), Some(5 * GIB));
    }

    #[test]
    fn groups_of_version_two_count_up_to_the_root() {
        let files = [
            ("proc/self/cgroup", "0::/batch/job\n"),
            ("sys/fs/cgroup/batch/job/memory.max", "max\n"),
            ("sys/fs/cgroup/batch/memory.max", "3221225472\n"),
            ("sys/fs/cgroup/batch/memory.current", "2147483648\n"),
            (
                "sys/fs/cgroup/batch/memory.stat",
                "anon 5\ninactive_file 1073741824\n",
            ),
        ];
        assert_eq!(available(&files[..4]), Some(GIB));
        assert_eq!(
            available(&files),
            Some(2 * GIB),
            "files that were read are given up"
        );
    }

    #[test]
    fn groups_of_version_one_count_where_a_container_sees_them() {
        let files = [
            (
                "proc/self/cgroup",
                "4:cpu,memory:/docker/0123\n1:cpuset:/\n",
            ),
            ("sys/fs/cgroup/memory/memory.limit_in_bytes", "2147483648\n"),
            ("sys/fs/cgroup/memory/memory.usage_in_bytes", "1073741824\n"),
        ];
        assert_eq!(available(&files), Some(GIB));
        let none = [
            ("proc/self/cgroup", "4:memory:/docker/0123\n"),
            (files[1].0, "9223372036854771712\n"),
        ];
        assert_eq!(available(&none), Some(8 * GIB));
    }
}
