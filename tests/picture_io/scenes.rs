//! The built-in pictures.

use crate::{mesh_of, sentence};
use homunculus::gallery;
use homunculus::importance::areas;

#[test]
fn the_gallery_opens() {
    let names: Vec<&str> = gallery::picture::list().map(|entry| entry.name).collect();
    assert_eq!(names, ["africa", "magnet", "crocodile", "snake"]);
    for name in names {
        let scene = gallery::picture::open(name).unwrap();
        let (picture, field) = (&scene.picture, &scene.field);
        assert!(
            picture.warnings.is_empty() && field.warnings.is_empty(),
            "{:?} {:?}",
            picture.warnings,
            field.warnings
        );
        assert!(picture.size.max_element() >= 800 && field.size == picture.size);
        assert!(field.values.iter().all(|f| (0.2..=5.0).contains(f)), "{name}");
        let area = picture.domain_area();
        assert!(area * 8 > picture.domain.len() && area < picture.domain.len());
        let grows = (0..picture.domain.len()).filter(|&i| picture.domain[i] && field.values[i] > 1.5).count();
        assert!(grows * 200 > area, "{name}: {grows} of {area} grow");
    }
    assert!(sentence(gallery::picture::open("cat")).contains("crocodile"));
}

#[test]
fn the_map_asks_for_the_area_it_has() {
    let scene = gallery::picture::open("africa").unwrap();
    let (picture, field) = (&scene.picture, &scene.field);
    let regions = field.regions.as_ref().unwrap();
    assert_eq!(regions.names.len(), 48);
    let mesh = mesh_of(picture, 4.0);
    let still = areas(field, picture, &mesh, &mesh.rest);
    let (asked, achieved): (f64, f64) = still.iter().fold((0.0, 0.0), |(a, b), r| (a + r.asked, b + r.achieved));
    assert!((asked / achieved - 1.0).abs() < 1e-3);
    // Nigeria has 1.9 times the people of Egypt: area is asked by density.
    let of = |name: &str| still.iter().find(|r| r.name == name).unwrap();
    let density = |name: &str, people: f64| people / of(name).achieved;
    let densities = density("Nigeria", 176_460_502.0) / density("Egypt", 91_812_566.0);
    let growth = |name: &str| of(name).asked / of(name).achieved;
    assert!((growth("Nigeria") / growth("Egypt") / densities - 1.0).abs() < 1e-2);
    // The projection is equal-area; outlines are coarse.
    let ratio = of("Chad").achieved / of("Zambia").achieved;
    assert!((ratio / (1_271_700.0 / 751_900.0) - 1.0).abs() < 0.04, "{ratio}");
}
