//! XML files as trees, which remember what of them was asked for.

use std::cell::Cell;
use std::path::Path;

use kluft_defect::ordinary_bytes;
use kluft_mesh::Defect;
use quick_xml::Reader;
use quick_xml::events::{BytesStart, Event};

/// Deeper trees are no project files.
const DEEPEST: usize = 64;

/// An element with what is in it.
#[derive(Debug, Default)]
pub struct Element {
    pub name: String,
    /// Its text, without spaces around.
    pub text: String,
    attributes: Vec<(String, String)>,
    children: Vec<Element>,
    is_taken: Cell<bool>,
}

impl Element {
    /// The outermost element of a file.
    ///
    /// # Errors
    /// If the file cannot be read.
    pub fn read(path: &Path) -> Result<Self, Vec<Defect>> {
        let defect = |problem: String| {
            let remedy = "give the path of an XML file as OpenGeoSys writes it, without includes";
            vec![Defect::new(path.display().to_string(), problem, remedy)]
        };
        let bytes =
            ordinary_bytes(path).map_err(|error| defect(format!("cannot be read: {error}")))?;
        // Latin-1, which such files say they are in, has each byte as a character.
        let latin = |bytes: &[u8]| bytes.iter().map(|&byte| char::from(byte)).collect();
        let text = std::str::from_utf8(&bytes).map_or_else(|_| latin(&bytes), str::to_owned);
        Self::parse(&text).map_err(defect)
    }

    fn parse(text: &str) -> Result<Self, String> {
        let mut reader = Reader::from_str(text);
        let mut open = vec![Self::default()];
        loop {
            let event = reader.read_event().map_err(|error| error.to_string())?;
            match event {
                Event::Start(tag) if open.len() < DEEPEST => open.push(Self::of(&tag)?),
                Event::Start(_) => return Err("its elements are nested too deeply".into()),
                Event::Empty(tag) => {
                    let own = Self::of(&tag)?;
                    open.last_mut()
                        .ok_or("it ends too early")?
                        .children
                        .push(own);
                }
                Event::End(_) => {
                    let mut own = open.pop().ok_or("it ends too early")?;
                    own.text = own.text.trim().to_owned();
                    open.last_mut()
                        .ok_or("it ends too early")?
                        .children
                        .push(own);
                }
                Event::Text(words) => {
                    open.last_mut().ok_or("it ends too early")?.text += &words.xml10_content();
                }
                Event::DocType(_) => return Err("document types are not read".into()),
                Event::Eof => break,
                _ => {}
            }
        }
        match (open.len(), open.pop().map(|mut top| top.children.pop())) {
            (1, Some(Some(root))) => Ok(root),
            _ => Err("it is not complete".into()),
        }
    }

    fn of(tag: &BytesStart<'_>) -> Result<Self, String> {
        let mut own = Self {
            name: tag.name().0.to_owned(),
            ..Self::default()
        };
        for attribute in tag.attributes() {
            let attribute = attribute.map_err(|error| error.to_string())?;
            let key = attribute.key.0.to_owned();
            own.attributes.push((key, attribute.value.into_owned()));
        }
        Ok(own)
    }

    /// An attribute.
    pub fn attribute(&self, name: &str) -> Option<&str> {
        let mut all = self.attributes.iter();
        all.find(|(key, _)| key == name)
            .map(|(_, value)| &value[..])
    }

    /// The elements in it with a name, which are taken with that.
    pub fn all<'a>(&'a self, name: &'a str) -> impl Iterator<Item = &'a Self> {
        let own = self.children.iter().filter(move |child| child.name == name);
        own.inspect(|child| child.is_taken.set(true))
    }

    /// The first element in it with a name.
    pub fn get(&self, name: &str) -> Option<&Self> {
        let mut own = self.children.iter();
        let found = own.find(|child| child.name == name)?;
        found.is_taken.set(true);
        Some(found)
    }

    /// The text of the first element in it with a name.
    pub fn word(&self, name: &str) -> Option<&str> {
        self.get(name).map(|child| &child.text[..])
    }

    /// Takes all in it with these names, and what is in them.
    pub fn pass_over(&self, names: &[&str]) {
        for child in &self.children {
            if names.contains(&&child.name[..]) {
                child.take_all();
            }
        }
    }

    fn take_all(&self) {
        self.is_taken.set(true);
        self.children.iter().for_each(Self::take_all);
    }

    /// Gives it back: nothing has come of it after all.
    pub fn leave(&self) {
        self.is_taken.set(false);
    }

    /// Where elements stand that nobody has asked for, with their texts.
    pub fn left(&self, path: &str, found: &mut Vec<String>) {
        for child in &self.children {
            let own = match child.attribute("id").or_else(|| child.word("name")) {
                Some(name) => format!("{path}/{} {name}", child.name),
                None => format!("{path}/{}", child.name),
            };
            match child.is_taken.get() {
                true => child.left(&own, found),
                false if child.text.is_empty() => found.push(own),
                false => found.push(format!("{own} = {}", child.text)),
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_nobody_asked_for_is_left() {
        let text = "<?xml version='1.0'?><a><b id='1'>x</b><b id='2'><c/> y </b><d>z</d></a>";
        let tree = Element::parse(text).expect("a tree");
        assert_eq!(tree.all("b").last().expect("b").text, "y");
        let mut left = Vec::new();
        tree.left("", &mut left);
        assert_eq!(left, ["/b 2/c", "/d = z"]);
    }

    #[test]
    fn what_is_no_tree_is_refused() {
        let deep = "<a>".repeat(100);
        for text in ["", "<a>", "<a></b>", "<!DOCTYPE a><a/>", "<a b></a>", &deep] {
            assert!(Element::parse(text).is_err(), "{text}");
        }
    }
}
