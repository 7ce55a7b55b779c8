//! Compiles the shim against the PETSc and the MPI that pkg-config finds: a signature that differs
//! is an error of the C compiler here, and not a crash there.

fn main() {
    let petsc = pkg_config::Config::new()
        .atleast_version("3.18")
        .probe("PETSc")
        .expect("PETSc 3.18 or newer, with pkg-config (`sh scripts/setup --mpi`)");
    let mpi = pkg_config::Config::new()
        .probe("mpi")
        .or_else(|_| pkg_config::Config::new().probe("mpich"))
        .expect("MPI, with pkg-config (`sh scripts/setup --mpi`)");
    cc::Build::new()
        .file("src/shim.c")
        .includes(petsc.include_paths.iter().chain(&mpi.include_paths))
        .flag("-std=c11")
        .flag("-Wall")
        .flag("-Wextra")
        .flag("-Wno-unused-parameter")
        .compile("kluft_shim");
    for path in petsc.link_paths.iter().chain(&mpi.link_paths) {
        println!("cargo:rustc-link-arg=-Wl,-rpath,{}", path.display());
    }
    println!("cargo:rerun-if-changed=src/shim.c");
}
