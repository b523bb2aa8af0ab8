//! Digests of results, and the files of the expected ones.
//!
//! `digests.tsv` holds digests of numbers: bits of results, counts and indices of enums. `text_digests.tsv` holds
//! digests of names, messages and files without their numbers. Each file has one column for processors with AVX2 and
//! FMA and one for the portable paths. `KINOPT_BLESS=1 cargo test --test same_bits` writes one column;
//! `KINOPT_PORTABLE=1` selects the portable one.

#![allow(clippy::unwrap_used)]

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::{Mutex, PoisonError};

use kinopt::Solution;

/// The FNV-1a hash function.
struct Hash(u64);

impl Hash {
    fn new() -> Self {
        Self(0xCBF2_9CE4_8422_2325)
    }

    fn byte(&mut self, byte: u8) {
        self.0 = (self.0 ^ u64::from(byte)).wrapping_mul(0x100_0000_01B3);
    }

    fn bytes(&mut self, bytes: &[u8]) {
        bytes.iter().for_each(|&byte| self.byte(byte));
    }
}

/// Hashes of numbers and of texts.
pub(crate) struct Digest {
    numbers: Hash,
    text: Hash,
}

/// Digests of numbers and of texts.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) struct Value {
    pub(crate) numbers: u64,
    pub(crate) text: u64,
}

impl Digest {
    pub(crate) fn new() -> Self {
        Self {
            numbers: Hash::new(),
            text: Hash::new(),
        }
    }

    pub(crate) fn value(self) -> Value {
        Value {
            numbers: self.numbers.0,
            text: self.text.0,
        }
    }

    pub(crate) fn word(&mut self, word: u64) {
        self.numbers.bytes(&word.to_le_bytes());
    }

    pub(crate) fn doubles(&mut self, values: impl IntoIterator<Item = f64>) {
        values.into_iter().for_each(|v| self.word(v.to_bits()));
    }

    pub(crate) fn singles(&mut self, values: impl IntoIterator<Item = f32>) {
        let values = values.into_iter().map(f32::to_bits);
        values.for_each(|v| self.word(v.into()));
    }

    /// A file or a debug text. Its numbers go to one hash and the rest to the other.
    pub(crate) fn bytes(&mut self, bytes: impl AsRef<[u8]>) {
        let bytes = bytes.as_ref();
        let Ok(text) = std::str::from_utf8(bytes) else {
            return self.numbers.bytes(bytes);
        };
        let is_name = |c: char| c.is_alphabetic() || c == '_';
        let mut rest = text;
        let mut in_name = false;
        while let Some(first) = rest.chars().next() {
            let digits = rest.len() - rest.trim_start_matches(|c: char| "+-.".contains(c)).len();
            let is_number = !in_name && rest[digits..].starts_with(|c: char| c.is_ascii_digit());
            if is_number {
                let is_part = |c: char| c.is_ascii_digit() || "+-.eE".contains(c);
                let (number, after) =
                    rest.split_at(rest.find(|c| !is_part(c)).unwrap_or(rest.len()));
                self.numbers.bytes(number.as_bytes());
                self.numbers.byte(b' ');
                self.text.byte(b'#');
                rest = after;
            } else {
                let (letter, after) = rest.split_at(first.len_utf8());
                self.text.bytes(letter.as_bytes());
                in_name = is_name(first) || (in_name && first.is_ascii_digit());
                rest = after;
            }
        }
    }

    /// A name or a message.
    pub(crate) fn text(&mut self, text: impl AsRef<str>) {
        self.text.bytes(text.as_ref().as_bytes());
        self.text.byte(b'\n');
    }

    /// All values of a solution.
    pub(crate) fn solution(&mut self, solution: &Solution) {
        self.doubles(solution.q.iter().copied());
        self.doubles([solution.cost, solution.projected_gradient.unwrap_or(-1.0)]);
        self.word(solution.termination as u64);
        self.text(solution.termination.name());
        let counts = solution.counts;
        for count in [
            solution.iterations,
            solution.attempts,
            solution.agreeing,
            counts.residuals,
            counts.jacobians,
            counts.gradients,
            usize::from(solution.reached),
            usize::from(solution.is_out_of_reach()),
        ] {
            self.word(count as u64);
        }
        for task in solution.tasks() {
            self.word(task.reached.into());
            for rows in task.rows {
                self.doubles([rows.error]);
                self.word(rows.reached.into());
            }
        }
        for limit in solution.active_limits() {
            self.text(limit.joint);
            self.text(format!("{:?} {:?}", limit.side, limit.kind));
            self.doubles([limit.value, limit.push]);
        }
        for name in solution.pulling_preferences() {
            self.text(name);
        }
    }
}

/// Whether the paths with AVX2 and FMA run here; the library decides alike.
fn is_fused() -> bool {
    #[cfg(target_arch = "x86_64")]
    return std::env::var_os("KINOPT_PORTABLE").is_none_or(|v| v.is_empty() || v == "0")
        && std::is_x86_feature_detected!("avx2")
        && std::is_x86_feature_detected!("fma");
    #[cfg(not(target_arch = "x86_64"))]
    false
}

/// What goes through glam, whose code for other architectures sums in another order.
const SINGLE_PRECISION: [&str; 7] = [
    "figures that are moved",
    "a capture on a robot, frame by frame",
    "a capture on a robot, as a whole",
    "rotations and Euler angles",
    "a clip of Euler keys",
    "packed skin",
    "skin of any influences",
];

/// One test at a time reads or writes a file.
static FILE: Mutex<()> = Mutex::new(());

/// Compares digests with the files, or writes them to the files if `KINOPT_BLESS` is set.
pub(crate) fn check(found: &[(&str, Value)]) {
    let _turn = FILE.lock().unwrap_or_else(PoisonError::into_inner);
    let numbers = found.iter().map(|(name, value)| (*name, value.numbers));
    let text = found.iter().map(|(name, value)| (*name, value.text));
    let numbers = differing(&numbers.collect::<Vec<_>>(), "digests.tsv");
    let text = differing(&text.collect::<Vec<_>>(), "text_digests.tsv");
    assert!(
        numbers.is_empty() && text.is_empty(),
        "numbers that differ from `digests.tsv`: {numbers:?}; texts that differ from `text_digests.tsv`: {text:?}. \
         See tests/same_bits/digest.rs for intended changes. {found:x?}"
    );
}

/// Names of the digests that differ from those of a file.
fn differing<'a>(found: &[(&'a str, u64)], file: &str) -> Vec<&'a str> {
    let file = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("same_bits")
        .join(file);
    let text = std::fs::read_to_string(&file).unwrap_or_default();
    let mut known: BTreeMap<&str, [String; 2]> = BTreeMap::new();
    for line in text.lines().filter(|line| !line.starts_with('#')) {
        let [name, fused, portable] = line.split('\t').collect::<Vec<_>>().try_into().unwrap();
        let previous = known.insert(name, [fused, portable].map(str::to_owned));
        assert!(previous.is_none(), "duplicate name `{name}`");
    }
    let column = usize::from(!is_fused());
    let found = found
        .iter()
        .map(|(name, digest)| (*name, format!("{digest:016x}")));
    let found: Vec<(&str, String)> = found.collect();
    if std::env::var_os("KINOPT_BLESS").is_some() {
        for (name, digest) in found {
            let both = known
                .entry(name)
                .or_insert_with(|| ["?", "?"].map(str::to_owned));
            both[column] = digest;
        }
        let mut text = String::from("# subject\tAVX2 and FMA\tportable\n");
        for (name, [fused, portable]) in known {
            text += &format!("{name}\t{fused}\t{portable}\n");
        }
        std::fs::write(file, text).unwrap();
        return Vec::new();
    }
    let known_to_be = |name: &str| known.get(name).map_or("nothing", |both| &both[column]);
    let differ = found
        .iter()
        .filter(|(name, digest)| digest != known_to_be(name))
        .filter(|(name, _)| cfg!(target_arch = "x86_64") || !SINGLE_PRECISION.contains(name));
    differ.map(|(name, _)| *name).collect()
}
