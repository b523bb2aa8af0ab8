//! Expected errors, and tables of faults in a text: what is replaced, by what, and what the error says.

/// A fault in a valid text.
pub struct Fault<'a> {
    /// The passage that is replaced.
    pub from: String,
    /// Its replacement.
    pub to: String,
    /// Parts of the expected error.
    pub parts: Vec<&'a str>,
}

impl Fault<'_> {
    /// The text with its one such passage replaced.
    pub fn applied(&self, text: &str) -> String {
        assert_eq!(text.matches(&self.from).count(), 1, "{}", self.from);
        text.replace(&self.from, &self.to)
    }

    /// Checks the error of reading the text with the fault.
    pub fn check<T, E: ToString>(&self, read: Result<T, E>) {
        assert!(
            read.is_err(),
            "`{}` instead of `{}` is accepted",
            self.to,
            self.from
        );
        read.says(&self.parts.join(" | "));
    }
}

/// Rows `FROM => TO | PART | PART …`, in which `\n` is a line break.
pub fn faults(table: &str) -> impl Iterator<Item = Fault<'_>> {
    table.lines().filter(|row| !row.is_empty()).map(|row| {
        let (from, rest) = row.split_once(" => ").unwrap();
        let mut parts = rest.split(" | ");
        let unescaped = |text: &str| text.replace("\\n", "\n");
        Fault {
            from: unescaped(from),
            to: unescaped(parts.next().unwrap()),
            parts: parts.collect(),
        }
    })
}

/// Checks of expected errors.
pub trait ExpectedError {
    /// Checks that the error contains parts that are separated by ` | `.
    fn says(self, parts: &str);
}

impl<T, E: ToString> ExpectedError for Result<T, E> {
    fn says(self, parts: &str) {
        let Err(error) = self else {
            panic!("was accepted; it should speak of {parts}")
        };
        let message = error.to_string();
        for part in parts.split(" | ") {
            assert!(message.contains(part), "no `{part}` in: {message}");
        }
    }
}
