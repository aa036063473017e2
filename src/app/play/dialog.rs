//! The system's dialogs for files.

use std::path::PathBuf;
use std::time::{Duration, Instant};

use crate::format::{Kind, Use};
use crate::importance::Ask;
use crate::panel::Asked;

/// Nobody closes a dialog as soon as this after it was asked for: then there was none.
const UNSEEN: Duration = Duration::from_millis(250);

/// Files chosen in the system's dialog; none in it where it was cancelled, `None` where the system shows no dialog. Waits
/// for the user.
pub(super) fn choose(asked: Asked, proposed: &str, kind: Kind) -> Option<Vec<PathBuf>> {
    let start = Instant::now();
    let files = shown(asked, proposed, kind);
    (!files.is_empty() || start.elapsed() > UNSEEN).then_some(files)
}

fn shown(asked: Asked, proposed: &str, kind: Kind) -> Vec<PathBuf> {
    let dialog = |title: &str| rfd::FileDialog::new().set_title(title);
    let to = |title: &str, name: &str, what: Use| -> Vec<PathBuf> {
        let dialog = dialog(title).set_file_name(proposed).add_filter(name, &what.extensions());
        dialog.save_file().into_iter().collect()
    };
    let word = kind.word();
    match asked {
        Asked::Open => {
            let sources = Kind::ALL.map(|kind| (format!("{}s", capital(kind.word())), Use::Source(kind)));
            let kinds: Vec<_> = [("Scenes".into(), Use::Scene)].into_iter().chain(sources).collect();
            let all: Vec<&str> = kinds.iter().flat_map(|(_, what)| what.extensions()).collect();
            let dialog = dialog("Open").add_filter("Everything that opens", &all);
            let dialog = kinds.iter().fold(dialog, |dialog, (name, what)| dialog.add_filter(name, &what.extensions()));
            dialog.pick_file().into_iter().collect()
        }
        Asked::Layer(offered) => {
            let files = offered.offer(kind).map_or(&[][..], |offer| offer.files);
            let pick = |file: &Ask| dialog(file.title).add_filter(file.name, &file.of.extensions()).pick_file();
            files.iter().map(pick).collect::<Option<_>>().unwrap_or_default()
        }
        Asked::SaveScene => to("Save the scene", "Scene", Use::Scene),
        Asked::ExportMesh => to(&format!("Save the warped {word}"), &capital(word), Use::Result(kind)),
        Asked::ExportGrowth => to("Save the growth", "Animation", Use::Growth(kind)),
        Asked::ExportReport => to("Save the report", "Report", Use::Report),
        Asked::ExportFilm => to("Where to record the film", "Film", Use::Film),
    }
}

/// With a capital.
fn capital(word: &str) -> String {
    let mut letters = word.chars();
    letters.next().map_or_else(String::new, |first| first.to_uppercase().chain(letters).collect())
}
