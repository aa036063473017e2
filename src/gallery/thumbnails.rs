//! A small picture of each scene, to choose it by: what `script/pictures` baked into `assets/gallery/thumbnails`.

/// Names and JPEG files of those that have one.
macro_rules! thumbnails {
    ($($name:literal),* $(,)?) => {
        [$(($name, include_bytes!(concat!("../../assets/gallery/thumbnails/", $name, ".jpg")).as_slice())),*]
    };
}

static THUMBNAILS: [(&str, &[u8]); 17] = thumbnails![
    "homunculus",
    "homunculus-innervation",
    "homunculus-motor",
    "hand",
    "airplane",
    "elephant",
    "colon",
    "lamp",
    "robot",
    "comic",
    "bike",
    "goalkeeper",
    "flowers",
    "africa",
    "magnet",
    "crocodile",
    "snake",
];

/// The certified result of a scene, as a square JPEG; `None` for a name that the gallery does not have.
pub fn thumbnail(name: &str) -> Option<&'static [u8]> {
    THUMBNAILS.iter().find(|(of, _)| *of == name).map(|(_, bytes)| *bytes)
}
