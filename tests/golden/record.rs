//! Recorded values of a case, and their file.
//!
//! `tests/golden/values/CASE.tsv` has a line a field: name, number of values, FNV-1a hash of their bits, first values.
//! `CASE.portable.tsv` exists if processors without AVX2 and FMA have other values.

use std::fmt::Write as _;
use std::path::PathBuf;

use glam::Affine3A;
use kinopt::Solution;
use kinopt::animation::Pose;
use kinopt::spatial::Placement;

/// Largest number of values that a line shows.
const MAX_SHOWN_VALUES: usize = 6;
/// Largest number of characters of a text that a line shows.
const MAX_SHOWN_CHARACTERS: usize = 80;

/// A computation with recorded values.
pub(crate) struct Case {
    /// Name of the case and of its file.
    pub(crate) name: &'static str,
    pub(crate) record: fn(&mut Record),
    /// True if values pass through glam, whose last bits differ between architectures.
    pub(crate) single_precision: bool,
}

impl Case {
    pub(crate) const fn double(name: &'static str, record: fn(&mut Record)) -> Self {
        Self {
            name,
            record,
            single_precision: false,
        }
    }

    pub(crate) const fn single(name: &'static str, record: fn(&mut Record)) -> Self {
        Self {
            name,
            record,
            single_precision: true,
        }
    }

    /// The lines of the case, computed now.
    pub(crate) fn lines(&self) -> Vec<String> {
        let mut record = Record::default();
        (self.record)(&mut record);
        record.lines
    }
}

/// Fields of a case in the order of their computation.
#[derive(Default)]
pub(crate) struct Record {
    lines: Vec<String>,
}

/// The FNV-1a hash function. `web/tests/bits.test.js` has the same one.
fn hash(bytes: impl IntoIterator<Item = u8>) -> u64 {
    let step = |hash: u64, byte: u8| (hash ^ u64::from(byte)).wrapping_mul(0x100_0000_01B3);
    bytes.into_iter().fold(0xCBF2_9CE4_8422_2325, step)
}

impl Record {
    fn line(&mut self, field: &str, count: usize, hash: u64, shown: &str) {
        self.lines
            .push(format!("{field}\t{count}\t{hash:016x}\t{shown}"));
    }

    pub(crate) fn numbers(&mut self, field: &str, values: impl IntoIterator<Item = f64>) {
        let values: Vec<f64> = values.into_iter().collect();
        let bytes = values.iter().flat_map(|v| v.to_bits().to_le_bytes());
        let mut shown = String::new();
        for value in values.iter().take(MAX_SHOWN_VALUES) {
            let _ = write!(shown, "{value:?} ");
        }
        self.line(field, values.len(), hash(bytes), shown.trim_end());
    }

    pub(crate) fn singles(&mut self, field: &str, values: impl IntoIterator<Item = f32>) {
        self.numbers(field, values.into_iter().map(f64::from));
    }

    pub(crate) fn counts(&mut self, field: &str, values: impl IntoIterator<Item = usize>) {
        self.numbers(field, values.into_iter().map(|count| count as f64));
    }

    pub(crate) fn text(&mut self, field: &str, text: &str) {
        let shown: String = text.escape_debug().take(MAX_SHOWN_CHARACTERS).collect();
        self.line(field, text.len(), hash(text.bytes()), &shown);
    }

    pub(crate) fn placements(&mut self, field: &str, placements: &[Placement<f64>]) {
        let numbers = placements.iter().flat_map(|placement| {
            let r = placement.rotation;
            [r.x, r.y, r.z, placement.translation].map(|column| column.to_array())
        });
        self.numbers(field, numbers.flatten());
    }

    pub(crate) fn affines(&mut self, field: &str, transforms: &[Affine3A]) {
        self.singles(field, transforms.iter().flat_map(Affine3A::to_cols_array));
    }

    pub(crate) fn poses<'a>(&mut self, field: &str, poses: impl IntoIterator<Item = &'a Pose>) {
        let mut numbers = Vec::new();
        for pose in poses {
            numbers.extend(pose.translations().iter().flat_map(|v| v.to_array()));
            numbers.extend(pose.rotations().iter().flat_map(|q| q.to_array()));
            numbers.extend(pose.scales().iter().flat_map(|v| v.to_array()));
        }
        self.singles(field, numbers);
    }

    /// Configurations, costs, counts, errors and active limits of solutions.
    pub(crate) fn solutions(&mut self, field: &str, solutions: &[Solution]) {
        let all = || solutions.iter();
        let named = |part: &str| format!("{field}.{part}");
        self.numbers(&named("q"), all().flat_map(|s| s.q.iter().copied()));
        self.numbers(&named("cost"), all().map(|s| s.cost));
        let errors = all().flat_map(Solution::tasks);
        let errors = errors.flat_map(|task| task.rows.iter().map(|rows| rows.error));
        self.numbers(&named("error"), errors);
        self.counts(&named("iterations"), all().map(|s| s.iterations));
        self.counts(&named("attempts"), all().map(|s| s.attempts));
        let evaluations = all().map(|s| s.counts.residuals + s.counts.jacobians);
        self.counts(&named("evaluations"), evaluations);
        let mut ends = String::new();
        for solution in solutions {
            let _ = write!(ends, "{} ", solution.termination.name());
            for limit in solution.active_limits() {
                let _ = write!(
                    ends,
                    "at {} {:?} {:e} ",
                    limit.joint, limit.side, limit.push
                );
            }
        }
        self.text(&named("end"), ends.trim_end());
    }
}

/// True if the code for AVX2 and FMA runs here.
fn is_fused() -> bool {
    #[cfg(target_arch = "x86_64")]
    return std::env::var_os("KINOPT_PORTABLE").is_none_or(|v| v.is_empty() || v == "0")
        && std::is_x86_feature_detected!("avx2")
        && std::is_x86_feature_detected!("fma");
    #[cfg(not(target_arch = "x86_64"))]
    false
}

fn path(name: &str, ending: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join(format!("golden/values/{name}{ending}"))
}

/// Compares cases with their files, or writes the files if `KINOPT_BLESS` is set.
pub(crate) fn check(cases: &[Case]) {
    let comparable = |case: &&Case| cfg!(target_arch = "x86_64") || !case.single_precision;
    let is_blessed = std::env::var_os("KINOPT_BLESS").is_some();
    let mut differences = String::new();
    for case in cases.iter().filter(comparable) {
        let computed = case.lines();
        if is_blessed {
            bless(case.name, &computed);
        } else if let Some(difference) = difference(case.name, &computed) {
            differences += &difference;
        }
    }
    assert!(
        differences.is_empty(),
        "{differences}`KINOPT_BLESS=1 cargo test -p kinopt-tests --test golden`, once more with `KINOPT_PORTABLE=1`, \
         records intended changes"
    );
}

fn bless(name: &str, computed: &[String]) {
    let text = computed.join("\n") + "\n";
    let (common, portable) = (path(name, ".tsv"), path(name, ".portable.tsv"));
    if is_fused() {
        std::fs::write(common, text).unwrap();
    } else if std::fs::read_to_string(common).is_ok_and(|recorded| recorded == text) {
        let _ = std::fs::remove_file(portable);
    } else {
        std::fs::write(portable, text).unwrap();
    }
}

/// The first differing field with its recorded and its computed value.
fn difference(name: &str, computed: &[String]) -> Option<String> {
    let mut file = path(name, ".portable.tsv");
    if is_fused() || !file.exists() {
        file = path(name, ".tsv");
    }
    let recorded = std::fs::read_to_string(&file).unwrap_or_default();
    let recorded: Vec<&str> = recorded.lines().collect();
    let count = recorded.len().max(computed.len());
    let line = |lines: &[&str], k: usize| (*lines.get(k).unwrap_or(&"nothing")).to_owned();
    let computed: Vec<&str> = computed.iter().map(String::as_str).collect();
    let k = (0..count).find(|&k| line(&recorded, k) != line(&computed, k))?;
    let (old, new) = (line(&recorded, k), line(&computed, k));
    let field = new.split('\t').next().unwrap_or_default();
    Some(format!(
        "{name}: field `{field}` differs from line {} of {}\n  recorded: {old}\n  computed: {new}\n",
        k + 1,
        file.display()
    ))
}

#[test]
fn difference_shows_both_values_of_the_first_field() {
    let mut record = Record::default();
    record.numbers("q", [1.0, -0.25]);
    record.text("end", "reached");
    assert_eq!(record.lines[0].matches('\t').count(), 3);
    assert!(record.lines[0].ends_with("\t1.0 -0.25"));
    let shown = difference("absent", &record.lines).unwrap();
    assert!(
        shown.contains("field `q`") && shown.contains("recorded: nothing"),
        "{shown}"
    );
    assert!(
        shown.contains("absent.tsv") && shown.contains("1.0 -0.25"),
        "{shown}"
    );
}
