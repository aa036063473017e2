//! The command line: `homunculus warp`, `homunculus inspect`.

use std::process::ExitCode;

fn main() -> ExitCode {
    homunculus::app::main(std::env::args_os())
}
