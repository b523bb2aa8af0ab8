//! Start configurations and the choice among solutions.

use std::str::FromStr;

use kinopt::arm::Search;

use super::number_list::{self, Numbers};

/// Start configuration of a search.
#[derive(Clone, Debug, Default)]
pub enum Start {
    /// Start of the arm or model.
    #[default]
    Default,
    /// Rest configuration.
    Rest,
    /// Crouched configuration above held frames.
    Bent,
    /// Random configuration.
    Random,
    /// Configuration.
    Numbers(Numbers),
}

impl FromStr for Start {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text.trim() {
            "default" => Ok(Self::Default),
            "rest" => Ok(Self::Rest),
            "bent" => Ok(Self::Bent),
            "random" => Ok(Self::Random),
            numbers => match numbers.parse() {
                Ok(numbers) => Ok(Self::Numbers(numbers)),
                Err(problem) if begins_with_number(numbers) => Err(problem),
                Err(_) => Err(
                    "expected `default`, `rest`, `bent`, `random` or the configuration's numbers"
                        .into(),
                ),
            },
        }
    }
}

impl Start {
    /// Start of an option, with its unit of angles.
    pub fn typed(&self, degrees: bool) -> Self {
        match self {
            Self::Numbers(numbers) => Self::Numbers(numbers.typed(degrees)),
            word => word.clone(),
        }
    }
}

fn begins_with_number(text: &str) -> bool {
    let word = text.split([',', ' ']).next().unwrap_or("");
    number_list::number(word).is_ok()
}

/// Choice among the solutions of a target.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SolutionChoice {
    /// The solution that a search prefers.
    One(Search),
    /// All solutions.
    All,
}

impl SolutionChoice {
    /// Search of the choice. All solutions need none.
    #[must_use]
    pub fn search(self) -> Search {
        match self {
            Self::One(search) => search,
            Self::All => Search::default(),
        }
    }
}

/// Parses a choice among solutions: `start`, `first`, `nearest` or `all`.
pub fn search(text: &str) -> Result<SolutionChoice, String> {
    match text {
        "start" => Ok(SolutionChoice::One(Search::Start)),
        "first" => Ok(SolutionChoice::One(Search::First)),
        "nearest" => Ok(SolutionChoice::One(Search::Nearest)),
        "all" => Ok(SolutionChoice::All),
        _ => Err("expected start, first, nearest or all".to_owned()),
    }
}
