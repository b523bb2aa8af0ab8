//! Digests of answers, and the file of those that every machine should find.
//!
//! `digests.tsv` holds them for processors with AVX2 and FMA and for the portable paths. A change of an
//! algorithm changes some: `KINOPT_BLESS=1 cargo test --test same_bits`, once as it is and once with
//! KINOPT_PORTABLE=1, writes the file anew. What is digested is the bits, and what was counted on the way:
//! a change that should change no answer changes no line.

#![allow(clippy::unwrap_used)]

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::{Mutex, PoisonError};

use kinopt::Solution;

/// FNV-1a over the bits of numbers.
pub(crate) struct Digest(u64);

impl Digest {
    pub(crate) fn new() -> Self {
        Self(0xCBF2_9CE4_8422_2325)
    }

    pub(crate) fn value(self) -> u64 {
        self.0
    }

    pub(crate) fn word(&mut self, word: u64) {
        for byte in word.to_le_bytes() {
            self.0 = (self.0 ^ u64::from(byte)).wrapping_mul(0x100_0000_01B3);
        }
    }

    pub(crate) fn doubles(&mut self, values: impl IntoIterator<Item = f64>) {
        values.into_iter().for_each(|v| self.word(v.to_bits()));
    }

    pub(crate) fn singles(&mut self, values: impl IntoIterator<Item = f32>) {
        let values = values.into_iter().map(f32::to_bits);
        values.for_each(|v| self.word(v.into()));
    }

    pub(crate) fn bytes(&mut self, bytes: impl AsRef<[u8]>) {
        let bytes = bytes.as_ref();
        bytes.iter().for_each(|&byte| self.word(byte.into()));
    }

    /// Everything that a solution says.
    pub(crate) fn solution(&mut self, solution: &Solution) {
        self.doubles(solution.q.iter().copied());
        self.doubles([solution.cost, solution.projected_gradient.unwrap_or(-1.0)]);
        self.bytes(solution.termination.name());
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
            self.bytes(limit.joint);
            self.bytes(format!("{:?} {:?}", limit.side, limit.kind));
            self.doubles([limit.value, limit.push]);
        }
        for name in solution.pulling_preferences() {
            self.bytes(name);
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

/// One test at a time reads or writes the file.
static FILE: Mutex<()> = Mutex::new(());

/// Compares digests with those of the file, or puts them there where that is asked for.
pub(crate) fn check(found: &[(&str, u64)]) {
    let _turn = FILE.lock().unwrap_or_else(PoisonError::into_inner);
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("same_bits/digests.tsv");
    let text = std::fs::read_to_string(&file).unwrap();
    let mut known: BTreeMap<&str, [String; 2]> = BTreeMap::new();
    for line in text.lines().filter(|line| !line.starts_with('#')) {
        let [name, fused, portable] = line.split('\t').collect::<Vec<_>>().try_into().unwrap();
        let twice = known.insert(name, [fused, portable].map(str::to_owned));
        assert!(twice.is_none(), "`{name}` stands twice in `digests.tsv`");
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
        let mut text = String::from("# what\tAVX2 and FMA\tportable\n");
        for (name, [fused, portable]) in known {
            text += &format!("{name}\t{fused}\t{portable}\n");
        }
        return std::fs::write(file, text).unwrap();
    }
    let known_to_be = |name: &str| known.get(name).map_or("nothing", |both| &both[column]);
    let differ = found
        .iter()
        .filter(|(name, digest)| digest != known_to_be(name))
        .filter(|(name, _)| cfg!(target_arch = "x86_64") || !SINGLE_PRECISION.contains(name));
    let differ: Vec<&str> = differ.map(|(name, _)| *name).collect();
    assert_eq!(
        differ, [""; 0],
        "answers, or what is counted on the way to them, are no longer those of `digests.tsv`: \
         if that is meant, write it anew (tests/same_bits/digest.rs says how). {found:?}"
    );
}
