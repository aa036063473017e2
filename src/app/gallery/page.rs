//! `index.html`: a page that opens from the disk, light or dark as the reader's system is.

use std::fmt::Write as _;

use super::exhibit::{Exhibit, Found, NAMES, SIDE, Worst};
use crate::view::Legend;

/// Everything that is the same for all scenes; colours are the window's.
const STYLE: &str = include_str!("page.css");

/// The page. Pictures are `pictures/SCENE-NAME.jpg` beside it.
pub(super) fn html(exhibits: &[Exhibit]) -> String {
    let certified = exhibits.iter().filter(|e| e.is_certified()).count();
    let found = || exhibits.iter().filter_map(|e| e.found.as_ref().ok());
    let crossings: usize = found().map(Found::classic_crossings).sum();
    let seconds: f64 = found().map(|found| found.seconds).sum();
    let mut page = format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
         <meta name=\"color-scheme\" content=\"light dark\">\n<title>homunculus: gallery</title>\n\
         <style>\n{STYLE}</style>\n</head>\n<body>\n<header>\n<h1>homunculus <span>gallery</span></h1>\n\
         <p class=\"lead\">Each body and each picture is warped until the size of its parts is proportional to their importance. \
         Classic deformation (the linear solution of Eq. 1 alone) passes through itself; what is shown as certified was \
         proven not to, in every frame of its growth, by exact arithmetic.</p>\n\
         <ul class=\"sum\"><li><b>{certified} of {}</b> scenes certified</li><li><b>{crossings}</b> crossings of Eq. 1 alone</li>\
         <li><b>{}</b> of ours</li><li><b>{seconds:.0} s</b> for all</li></ul>\n<nav>",
        exhibits.len(),
        found().map(Found::faults).sum::<usize>(),
    );
    for exhibit in exhibits {
        let name = exhibit.entry.name;
        let _ = write!(
            page,
            "<a class=\"{}\" href=\"#{name}\">{name}</a>",
            if exhibit.is_certified() { "good" } else { "bad" }
        );
    }
    page.push_str("</nav>\n</header>\n<main>\n");
    exhibits.iter().for_each(|exhibit| scene(&mut page, exhibit));
    let _ = write!(
        page,
        "</main>\n<footer><p>Made by <code>homunculus gallery --render</code>, version {}. All on one sheet: \
         <a href=\"contact-sheet.png\">contact-sheet.png</a>.</p></footer>\n</body>\n</html>\n",
        env!("CARGO_PKG_VERSION")
    );
    page
}

fn scene(page: &mut String, exhibit: &Exhibit) {
    let entry = &exhibit.entry;
    let (light, verdict) = match &exhibit.found {
        Ok(found) if found.report.certified() => ("good", "certified in every frame"),
        Ok(_) => ("bad", "not certified"),
        Err(_) => ("bad", "failed"),
    };
    let _ = write!(
        page,
        "<article id=\"{0}\">\n<h2>{0}</h2><p class=\"light {light}\">{verdict}</p>\n<p class=\"what\">{1}</p>\n",
        escaped(entry.name),
        escaped(&capital(entry.one_line)),
    );
    match &exhibit.found {
        Ok(found) => {
            pictures(page, entry.name, found);
            facts(page, found);
            regions(page, found);
        }
        Err(why) => {
            let _ = writeln!(page, "<p class=\"failure\">{}</p>", escaped(why));
        }
    }
    let _ = write!(
        page,
        "<p class=\"source\">Source: {}. Yours: <code>homunculus play gallery:{}</code></p>\n</article>\n",
        escaped(entry.reference),
        escaped(entry.name)
    );
}

fn pictures(page: &mut String, name: &str, found: &Found) {
    page.push_str("<div class=\"row\">\n");
    for (k, (file, caption)) in NAMES.into_iter().enumerate() {
        let beside = match k {
            1 => legend(&found.legend),
            2 => format!("<em class=\"bad\">{}</em>", crossings(found.classic_crossings())),
            3 => {
                let kind = if found.faults() == 0 { "good" } else { "bad" };
                format!("<em class=\"{kind}\">{}</em>", crossings(found.faults()))
            }
            _ => String::new(),
        };
        let _ = writeln!(
            page,
            "<figure><img src=\"pictures/{name}-{file}.jpg\" width=\"{SIDE}\" height=\"{SIDE}\" loading=\"lazy\" \
             alt=\"{name}, {caption}\"><figcaption>{caption}{beside}</figcaption></figure>"
        );
    }
    page.push_str("</div>\n");
    if found.classic_crossings() == 0 {
        page.push_str("<p class=\"note\">Eq. 1 alone does not cross itself here: the importance is not strong enough to show the point.</p>\n");
    }
}

fn crossings(count: usize) -> String {
    match count {
        1 => "1 crossing".into(),
        n => format!("{n} crossings"),
    }
}

/// A bar of colours between its ends.
fn legend(legend: &Legend) -> String {
    let stops: Vec<String> =
        legend.stops.iter().step_by(8).map(|(_, [r, g, b])| format!("#{r:02x}{g:02x}{b:02x}")).collect();
    let tick = |tick: Option<&(f32, String)>| tick.map_or_else(String::new, |(_, text)| escaped(text));
    format!(
        "<span class=\"legend\">{}<i style=\"background:linear-gradient(90deg,{})\"></i>{}</span>",
        tick(legend.ticks.first()),
        stops.join(","),
        tick(legend.ticks.last())
    )
}

fn facts(page: &mut String, found: &Found) {
    let report = &found.report;
    let mut all: Vec<(&str, String)> = Vec::new();
    if let Some(worst) = found.worst() {
        all.push(("worst region", format!("{} <small>{}</small>", percent(worst.error()), asked_and_achieved(&worst))));
    }
    all.push((
        "size error p95",
        format!("{:.1} % <small>median {:.1} %</small>", 100.0 * report.fidelity.p95, 100.0 * report.fidelity.median),
    ));
    let inverted = found.classic_inverted();
    if inverted > 0 {
        all.push(("Eq. 1 alone", format!("{inverted} <small>inverted elements</small>")));
    }
    all.push(("solved in", format!("{:.1} s", found.seconds)));
    all.push((
        "lattice",
        format!("{} <small>cells along, {} in all</small>", report.settings.resolution, report.domain.cells),
    ));
    all.push(("fidelity μ", format!("{}", report.settings.fidelity)));
    all.push(("frames", format!("{}", report.certificate.frames.len())));
    page.push_str("<dl>");
    for (name, value) in all {
        let _ = write!(page, "<div><dt>{name}</dt><dd>{value}</dd></div>");
    }
    page.push_str("</dl>\n");
}

fn percent(part: f64) -> String {
    let sign = if part < 0.0 { "−" } else { "+" };
    format!("{sign}{:.1} %", 100.0 * part.abs())
}

fn asked_and_achieved(worst: &Worst) -> String {
    let name = escaped(&worst.name.replace('_', " "));
    if worst.is_area {
        format!("{name}: area {:.0} of {:.0} px", worst.achieved, worst.asked)
    } else {
        format!("{name}: ×{:.2} of ×{:.2}", worst.achieved, worst.asked)
    }
}

/// Every region, folded away.
fn regions(page: &mut String, found: &Found) {
    let report = &found.report;
    let rows: Vec<(&str, f64, f64)> = match &report.areas {
        Some(areas) => areas.regions.iter().map(|a| (a.name.as_str(), a.asked, a.achieved)).collect(),
        None => report.fidelity.regions.iter().map(|r| (r.name.as_str(), r.asked, r.achieved)).collect(),
    };
    if rows.is_empty() {
        return;
    }
    let (unit, digits) = if report.areas.is_some() { ("area, px", 0) } else { ("size factor", 2) };
    let _ = write!(
        page,
        "<details><summary>{} regions</summary>\n<table><thead><tr><th>region</th><th>asked</th><th>achieved ({unit})</th>\
         <th>off</th></tr></thead><tbody>\n",
        rows.len()
    );
    for (name, asked, achieved) in rows {
        let _ = writeln!(
            page,
            "<tr><td>{}</td><td>{asked:.digits$}</td><td>{achieved:.digits$}</td><td>{}</td></tr>",
            escaped(&name.replace('_', " ")),
            percent(achieved / asked - 1.0)
        );
    }
    page.push_str("</tbody></table></details>\n");
}

/// A sentence begins with a capital.
fn capital(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or_else(String::new, |first| first.to_uppercase().chain(letters).collect()) + "."
}

/// Text as HTML.
fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gallery::Entry;

    #[test]
    fn a_failure_is_told_and_text_is_escaped() {
        let entry = Entry {
            name: "x",
            kind: crate::format::Kind::Body,
            one_line: "a < b",
            reference: "\"c\"",
            resolution: 8,
            fidelity: 0.5,
            camera: [0.0; 2],
        };
        let page = html(&[Exhibit { entry, found: Err("no <driver>".into()) }]);
        assert!(page.contains("class=\"failure\">no &lt;driver&gt;<") && page.contains("0 of 1"), "{page}");
        assert!(page.contains("A &lt; b.") && page.contains("Source: &quot;c&quot;."));
        assert!(!page.contains("src=\"pictures/x"), "there are no pictures of what failed");
    }
}
