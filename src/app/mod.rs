//! The faces of the program: each puts the same stages together and replaces none.
//!
//! Exit codes, which others script by:
//!
//! | code | meaning |
//! |---|---|
//! | 0 | done; for `warp` and `record`: certified |
//! | 1 | stopped, could not write, or a fault of this program |
//! | 2 | the input or the options are bad, or nothing here can draw |
//! | 3 | finished but not certified; the result lies next to its report |

mod cancel;
mod gallery;
mod inspect;
mod load;
pub mod options;
mod outputs;
#[cfg(feature = "window")]
pub mod play;
mod progress;
#[cfg(feature = "record")]
mod record;
mod warp;

use std::ffi::OsString;
use std::io::Write;
use std::process::ExitCode;

use options::Order;

use crate::{Error, Result};

/// How a command ended that did end.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Verdict {
    Done,
    NotCertified,
}

/// Runs the program with these arguments, the first being its own name.
pub fn main(arguments: impl IntoIterator<Item = OsString>) -> ExitCode {
    let order = match options::parse(arguments) {
        Ok(order) => order,
        Err(refusal) => {
            let code = if refusal.use_stderr() { 2 } else { 0 };
            // Printing fails only where nobody reads.
            let _ = refusal.print();
            return ExitCode::from(code);
        }
    };
    // A panic is a fault of ours; its message is out already, the exit code is the one promised.
    match std::panic::catch_unwind(|| run(order)) {
        Ok(Ok(Verdict::Done)) => ExitCode::SUCCESS,
        Ok(Ok(Verdict::NotCertified)) => ExitCode::from(3),
        Ok(Err(error)) => {
            note(&format!("error: {error}"));
            ExitCode::from(exit_code(&error))
        }
        Err(_) => {
            note("error: internal fault; please report it with the input");
            ExitCode::from(1)
        }
    }
}

fn run(order: Order) -> Result<Verdict> {
    match order {
        Order::Warp(order) => warp::run(&order),
        Order::Inspect(order) => inspect::run(&order),
        Order::Gallery(options) => gallery::run(&options),
        #[cfg(feature = "record")]
        Order::Record(order) => record::run(&order),
        #[cfg(feature = "window")]
        Order::Play(order) => play::run(&order),
    }
}

/// 2 when the input or an option is bad, else 1.
fn exit_code(error: &Error) -> u8 {
    match error {
        Error::Input(_) | Error::File { what: "cannot read", .. } => 2,
        Error::File { .. } | Error::Cancelled | Error::Fault(_) => 1,
    }
}

/// A line of result. A closed pipe is no error: nobody reads.
fn say(line: &str) {
    let _ = writeln!(std::io::stdout().lock(), "{line}");
}

/// A line beside the result.
fn note(line: &str) {
    let _ = writeln!(std::io::stderr().lock(), "{line}");
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;

    #[test]
    fn each_error_has_its_code() {
        let io = || std::io::Error::other("x");
        assert_eq!(exit_code(&Error::input("x")), 2);
        assert_eq!(exit_code(&Error::reading(Path::new("x"), io())), 2);
        assert_eq!(exit_code(&Error::writing(Path::new("x"), io())), 1);
        assert_eq!(exit_code(&Error::Cancelled), 1);
        assert_eq!(exit_code(&Error::Fault("x".into())), 1);
    }
}
