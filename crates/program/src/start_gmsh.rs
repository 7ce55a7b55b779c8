//! A hidden mode: this process prepares itself and becomes gmsh, as [`kluft_io::gmsh::Launcher`]
//! says it.
//!
//! A geometry is a program that gmsh obeys. So gmsh can execute nothing but itself, write only in
//! the folder of its run, and open no connection; it does not outlive who started it, and its
//! addresses are not random, on which some of its meshes depend.

use std::ffi::OsString;
use std::io;
use std::os::unix::process::CommandExt;
use std::path::{Path, PathBuf};
use std::process::Command;

use clap::Args;
use kluft_io::gmsh::NOT_STARTED;
use kluft_run::memory;
use landlock::{
    ABI, Access, AccessFs, AccessNet, CompatLevel, Compatible, Ruleset, RulesetAttr,
    RulesetCreated, RulesetCreatedAttr, RulesetError, Scope, path_beneath_rules,
};
use nix::sys::personality::{self, Persona};
use nix::sys::prctl;
use nix::sys::resource::{Resource, getrlimit, setrlimit};
use nix::sys::signal::Signal;

use executable::needed_by;

mod executable;

/// Least memory that gmsh is left (bytes), whatever the system says; its libraries alone map 1 GB.
const LEAST_MEMORY: u64 = 4 << 30;

/// What the launcher is told.
#[derive(Args)]
pub struct StartArgs {
    /// The process that gmsh must not outlive
    #[arg(long, value_name = "PID")]
    parent: i32,
    /// Keep gmsh from everything that a mesh does not need
    #[arg(long)]
    confine: bool,
    /// The folder that it may write to
    #[arg(long, value_name = "DIR")]
    folder: Option<PathBuf>,
    /// A file or a folder that it may read
    #[arg(long, value_name = "PATH")]
    read: Vec<PathBuf>,
    /// gmsh and its arguments
    #[arg(last = true, required = true)]
    command: Vec<OsString>,
}

/// Whether gmsh can be confined on this machine.
pub fn can_confine() -> bool {
    rules().is_ok()
}

/// Becomes gmsh; returns only if that fails, with an exit code.
pub fn start(args: &StartArgs) -> u8 {
    let why = become_gmsh(args);
    let text = format!("{why}\n");
    // Whoever started it reads its error stream.
    let _ = io::Write::write_all(&mut io::stderr().lock(), text.as_bytes());
    NOT_STARTED
}

fn become_gmsh(args: &StartArgs) -> String {
    if let Err(error) = live_no_longer_than(args.parent) {
        return error.to_string();
    }
    if fix_addresses().is_err() {
        let text = b"Warning : the system does not let addresses be fixed: meshes may vary\n";
        // A warning that cannot be written is no reason to make no mesh.
        let _ = io::Write::write_all(&mut io::stderr().lock(), text);
    }
    if let Err(error) = limit() {
        return error.to_string();
    }
    let [program, arguments @ ..] = args.command.as_slice() else {
        return "no program is given".to_owned();
    };
    if args.confine
        && let Err(error) = confine(args, Path::new(program))
    {
        return format!("it cannot be confined: {error}");
    }
    Command::new(program).args(arguments).exec().to_string()
}

/// The parent may have died before the signal was asked for.
fn live_no_longer_than(parent: i32) -> io::Result<()> {
    prctl::set_pdeathsig(Signal::SIGKILL)?;
    if nix::unistd::getppid().as_raw() != parent {
        return Err(io::Error::other("who started it is gone"));
    }
    Ok(())
}

fn fix_addresses() -> nix::Result<()> {
    let persona = personality::get()?;
    personality::set(persona | Persona::ADDR_NO_RANDOMIZE).map(drop)
}

/// No core dump; memory, and files to be read into it, within what the machine has.
fn limit() -> nix::Result<()> {
    lower(Resource::RLIMIT_CORE, 0)?;
    let Some(available) = memory::available_bytes() else {
        return Ok(());
    };
    let memory = LEAST_MEMORY.max(available as u64);
    lower(Resource::RLIMIT_AS, memory)?;
    lower(Resource::RLIMIT_FSIZE, memory)
}

fn lower(resource: Resource, limit: u64) -> nix::Result<()> {
    let (_, most) = getrlimit(resource)?;
    let limit = limit.min(most);
    setrlimit(resource, limit, limit)
}

/// An empty set of rules: whatever no rule allows is forbidden. The rights of the first Landlock
/// must be there; later kernels know more.
fn rules() -> Result<RulesetCreated, RulesetError> {
    let first = Ruleset::default()
        .set_compatibility(CompatLevel::HardRequirement)
        .handle_access(AccessFs::from_all(ABI::V1))?;
    let more = first.set_compatibility(CompatLevel::BestEffort);
    more.handle_access(AccessFs::from_all(ABI::V5))?
        .handle_access(AccessNet::from_all(ABI::V4))?
        .scope(Scope::from_all(ABI::V6))?
        .create()
}

fn confine(args: &StartArgs, program: &Path) -> Result<(), RulesetError> {
    let read = AccessFs::ReadFile | AccessFs::ReadDir;
    let needed = needed_by(program);
    let mut write = AccessFs::from_all(ABI::V5);
    write.remove(AccessFs::Execute);
    rules()?
        .add_rules(path_beneath_rules(OF_THE_SYSTEM, read))?
        .add_rules(path_beneath_rules(&needed.read, read))?
        .add_rules(path_beneath_rules(
            &needed.execute,
            read | AccessFs::Execute,
        ))?
        .add_rules(path_beneath_rules(&args.read, read))?
        .add_rules(path_beneath_rules(
            ["/dev/null"],
            read | AccessFs::WriteFile,
        ))?
        .add_rules(path_beneath_rules(&args.folder, write))?
        .restrict_self()
        .map(drop)
}

/// What programs and their libraries read; nothing of a user is there.
const OF_THE_SYSTEM: [&str; 17] = [
    "/usr",
    "/lib",
    "/lib64",
    "/nix/store",
    "/etc/ld.so.cache",
    "/etc/ld.so.conf",
    "/etc/ld.so.conf.d",
    "/etc/ld.so.preload",
    "/etc/localtime",
    "/dev/zero",
    "/dev/random",
    "/dev/urandom",
    "/proc/self",
    "/proc/cpuinfo",
    "/proc/meminfo",
    "/proc/stat",
    "/sys/devices/system",
];
