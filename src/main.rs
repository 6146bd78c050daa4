//! The `coif` program: see [`coif::cli`].

fn main() -> std::process::ExitCode {
    coif::cli::main()
}
