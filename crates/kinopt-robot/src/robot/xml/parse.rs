//! XML parsing, with corrections of malformed documents for lenient readers.

use std::borrow::Cow;

use roxmltree::{Document, Error};

use super::error::{Read, RobotFileError};
use super::repair::{Repair, RepairKind};

/// Largest number of malformed declarations and undeclared prefixes that are corrected; files have one.
const MAX_XML_REPAIRS: usize = 16;

/// Parses well-formed XML.
pub(crate) fn parse<'a>(file: &str, text: &'a str) -> Read<Document<'a>> {
    Document::parse(text).map_err(|error| match &error {
        Error::UnknownNamespace(prefix, at) if prefix == "xacro" => RobotFileError::Xacro {
            file: file.to_owned(),
            line: at.row,
        },
        _ => RobotFileError::NotXml {
            file: file.to_owned(),
            problem: error.to_string(),
        },
    })
}

/// The text with misplaced XML declarations blanked out and undeclared prefixes declared. Line numbers do not change.
pub(crate) fn repaired_xml<'a>(text: &'a str, repairs: &mut Vec<Repair>) -> Cow<'a, str> {
    let mut note = |line, element: &str, kind| {
        let element = element.to_owned();
        repairs.push(Repair {
            line,
            element,
            mended: kind,
        });
    };
    let mut text = Cow::Borrowed(text);
    for _ in 0..MAX_XML_REPAIRS {
        let next = match Document::parse(&text) {
            Err(Error::UnexpectedDeclaration(at)) => {
                note(at.row, "<?xml?>", RepairKind::DeclarationRemoved);
                without_declaration(&text, at.row as usize)
            }
            Err(Error::UnknownNamespace(prefix, at)) if prefix != "xacro" => {
                let next = with_prefix(&text, &prefix);
                note(at.row, "<robot>", RepairKind::PrefixDeclared { prefix });
                next
            }
            _ => break,
        };
        match next {
            Some(next) => text = Cow::Owned(next),
            None => break,
        }
    }
    text
}

/// Replaces the first declaration on or after a line by spaces and keeps line ends.
fn without_declaration(text: &str, row: usize) -> Option<String> {
    let line_start: usize = text.split_inclusive('\n').take(row - 1).map(str::len).sum();
    let start = line_start + text.get(line_start..)?.find("<?xml")?;
    let end = start + text.get(start..)?.find("?>")? + 2;
    let blank = text.get(start..end)?.replace(|c| c != '\n', " ");
    Some(format!("{}{blank}{}", text.get(..start)?, text.get(end..)?))
}

/// Declares a prefix on the root element.
fn with_prefix(text: &str, prefix: &str) -> Option<String> {
    let at = text.find("<robot")? + "<robot".len();
    Some(format!(
        "{} xmlns:{prefix}=\"undeclared:{prefix}\"{}",
        text.get(..at)?,
        text.get(at..)?
    ))
}

/// Name of the root element, from the start of the text only; `None` if there is none.
#[cfg(feature = "mjcf")]
pub(crate) fn root_name(text: &str) -> Option<&str> {
    let mut rest = text.trim_start_matches('\u{feff}').trim_start();
    loop {
        let end = match rest {
            _ if rest.starts_with("<?") => "?>",
            _ if rest.starts_with("<!--") => "-->",
            _ => break,
        };
        rest = rest.split_once(end)?.1.trim_start();
    }
    let name = rest.strip_prefix('<')?;
    name.split(|c: char| c.is_whitespace() || c == '/' || c == '>')
        .next()
}
