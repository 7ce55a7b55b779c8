//! A scene in the making.

/// What has been said, and what has no counterpart.
#[derive(Default)]
pub struct Said {
    pub scene: String,
    pub notes: Vec<String>,
}

impl Said {
    /// Takes the value of a key over, or says why not.
    pub fn number(&mut self, key: &str, found: Result<f64, String>) {
        match found {
            Ok(value) => self.scene += &format!("{key} = {value:?}\n"),
            Err(why) => {
                self.scene += &format!("# {key}: {why}\n");
                self.notes.push(format!("`{key}` is missing: {why}"));
            }
        }
    }
}
