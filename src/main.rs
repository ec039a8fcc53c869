//! The `flow` command: arguments → `cli` → exit code.

fn main() -> std::process::ExitCode {
    flow::cli::main()
}
