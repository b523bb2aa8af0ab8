//! Real roots of trigonometric polynomials.
//!
//! A trigonometric polynomial of degree N is a homogeneous polynomial of degree 2N in the cosine and sine of the half
//! angle. Its Bernstein coefficients on an arc enclose it. Descartes' rule of signs isolates the roots: an arc without
//! a sign variation has no root, and an arc with one variation has one root. Other arcs are halved.

use super::angle::Angle;

/// Coefficient, relative to the sum of all, below which a sign is unknown, if the polynomial is exact.
const NOISE: f64 = 1e-13;
/// Halvings after which an arc whose coefficients are all noise counts as a root.
const MIN_HALVINGS: u32 = 7;
/// Largest number of halvings.
const MAX_HALVINGS: u32 = 20;
/// Largest number of arcs that wait: the nearer one is halved first, and the farther of each halving waits.
const MAX_ARCS: usize = MAX_HALVINGS as usize + 2;
/// Largest number of steps to a bracketed root.
const MAX_STEPS: usize = 60;
/// Number of steps after which every second one halves the bracket: slopes of very different sizes need it.
const BISECTION_AFTER: usize = 10;
/// Number of bisections to an extremum.
const EXTREMUM_STEPS: usize = 20;
/// Width of a bracket that needs no further step, as a fraction of its arc.
const NARROW: f64 = 1e-12;
/// Largest degree.
const MAX_DEGREE: usize = 8;
/// Largest number of samples beyond the number of coefficients.
const MAX_EXTRA_SAMPLES: usize = 7;
const MAX_COEFFICIENTS: usize = 2 * MAX_DEGREE + 1;

/// Root of a trigonometric polynomial.
#[derive(Clone, Copy, Debug)]
pub(super) struct AngleRoot {
    pub(super) angle: Angle,
    /// True if the polynomial changes its sign at the root and near it at no other angle.
    pub(super) is_simple: bool,
}

/// a₀ + Σ aₖ·cos kθ + bₖ·sin kθ for k = 1 … N.
#[derive(Clone, Copy, Debug)]
pub(super) struct Trigonometric {
    degree: usize,
    constant: f64,
    cos: [f64; MAX_DEGREE],
    sin: [f64; MAX_DEGREE],
}

/// Arc between two half angles, and the Bernstein coefficients on it.
#[derive(Clone, Copy, Debug)]
struct BernsteinArc {
    coefficients: [f64; MAX_COEFFICIENTS],
    /// Ends as (cosine, sine) of the half angle, of any length.
    ends: [(f64, f64); 2],
    halvings: u32,
}

/// Finder of the roots of polynomials of one degree.
#[derive(Clone, Debug)]
pub(super) struct RootFinder {
    degree: usize,
    /// Number of halvings after which close roots are no longer separated.
    max_halvings: u32,
    /// Number of halvings at which an extremum without a sign change counts as a root, if any.
    touching_halvings: Option<u32>,
    /// Bernstein coefficients of cos kθ and sin kθ on the arc from 0 to π, for k = 0 … N.
    cos: [[f64; MAX_COEFFICIENTS]; MAX_DEGREE + 1],
    sin: [[f64; MAX_COEFFICIENTS]; MAX_DEGREE + 1],
}

fn binomial(n: usize, k: usize) -> f64 {
    (0..k).fold(1.0, |product, i| product * (n - i) as f64 / (i + 1) as f64)
}

impl Trigonometric {
    /// Interpolates a polynomial of degree N ≤ 8 at 2N + 1 + `extra` equidistant angles.
    ///
    /// Returns it with the largest deviation from the samples, relative to the largest sample.
    pub(super) fn fit(degree: usize, extra: usize, f: impl Fn(Angle) -> f64) -> (Self, f64) {
        let degree = degree.min(MAX_DEGREE);
        let mut samples = [0.0; MAX_COEFFICIENTS + MAX_EXTRA_SAMPLES];
        let mut angles = [Angle::ZERO; MAX_COEFFICIENTS + MAX_EXTRA_SAMPLES];
        let count = (2 * degree + 1 + extra).min(samples.len());
        let step = Angle::of_radians(std::f64::consts::TAU / count as f64);
        let mut angle = Angle::ZERO;
        for (sample, at) in samples.iter_mut().zip(&mut angles).take(count) {
            *at = angle;
            *sample = f(angle);
            angle = angle.plus(step);
        }
        let scale = 2.0 / count as f64;
        let mut polynomial = Self {
            degree,
            constant: samples[..count].iter().sum::<f64>() * 0.5 * scale,
            cos: [0.0; MAX_DEGREE],
            sin: [0.0; MAX_DEGREE],
        };
        for k in 1..=degree {
            let (mut cos, mut sin) = (0.0, 0.0);
            for (i, sample) in samples[..count].iter().enumerate() {
                let angle = angles[i * k % count];
                cos += sample * angle.cos;
                sin += sample * angle.sin;
            }
            (polynomial.cos[k - 1], polynomial.sin[k - 1]) = (cos * scale, sin * scale);
        }
        let (mut deviation, mut largest) = (0.0_f64, f64::MIN_POSITIVE);
        if extra > 0 {
            for (sample, angle) in samples.iter().zip(&angles).take(count) {
                deviation = deviation.max((polynomial.at(*angle) - sample).abs());
                largest = largest.max(sample.abs());
            }
        }
        (polynomial, deviation / largest)
    }

    fn harmonics(&self) -> impl Iterator<Item = (&f64, &f64)> {
        self.cos.iter().zip(&self.sin).take(self.degree)
    }

    /// Value at an angle.
    pub(super) fn at(&self, angle: Angle) -> f64 {
        let mut power = angle;
        let mut sum = self.constant;
        for (cos, sin) in self.harmonics() {
            sum += cos * power.cos + sin * power.sin;
            power = power.plus(angle);
        }
        sum
    }

    /// Derivative at an angle.
    pub(super) fn slope_at(&self, angle: Angle) -> f64 {
        let mut power = angle;
        let mut sum = 0.0;
        for (k, (cos, sin)) in self.harmonics().enumerate() {
            sum += (k + 1) as f64 * (sin * power.cos - cos * power.sin);
            power = power.plus(angle);
        }
        sum
    }

    /// Sum of the absolute coefficients.
    pub(super) fn size(&self) -> f64 {
        let harmonics = self.harmonics().map(|(cos, sin)| cos.abs() + sin.abs());
        self.constant.abs() + harmonics.sum::<f64>()
    }

    /// Half angle of the extremum between the ends of an arc, by bisection of the slope; `None` without a sign change.
    fn extremum(
        &self,
        [mut low, mut high]: [(f64, f64); 2],
        at: impl Fn((f64, f64)) -> Angle,
    ) -> Option<(f64, f64)> {
        let slope_low = self.slope_at(at(low));
        if slope_low * self.slope_at(at(high)) > 0.0 {
            return None;
        }
        for _ in 0..EXTREMUM_STEPS {
            let middle = (0.5 * (low.0 + high.0), 0.5 * (low.1 + high.1));
            match slope_low * self.slope_at(at(middle)) > 0.0 {
                true => low = middle,
                false => high = middle,
            }
        }
        Some(low)
    }

    /// The root between the ends of an arc, by the Illinois method with bisection. `at` gives the angle of a half angle.
    fn bracketed(&self, [a, b]: [(f64, f64); 2], at: impl Fn((f64, f64)) -> Angle) -> Angle {
        let point = |t: f64| at((a.0 + t * (b.0 - a.0), a.1 + t * (b.1 - a.1)));
        let (mut low, mut high) = (0.0, 1.0);
        let (mut f_low, mut f_high) = (self.at(at(a)), self.at(at(b)));
        let mut moved_high = None;
        for step in 0..MAX_STEPS {
            if high - low < NARROW || f_low * f_high >= 0.0 {
                break;
            }
            let t = match step > BISECTION_AFTER && step % 2 == 0 {
                true => 0.5 * (low + high),
                false => (low * f_high - high * f_low) / (f_high - f_low),
            };
            let f = self.at(point(t));
            if f == 0.0 || (t - low).min(high - t) < 0.1 * NARROW {
                return point(t);
            }
            let moves_high = f * f_low < 0.0;
            if moves_high {
                (high, f_high) = (t, f);
            } else {
                (low, f_low) = (t, f);
            }
            if moved_high == Some(moves_high) {
                *(if moves_high { &mut f_low } else { &mut f_high }) *= 0.5;
            }
            moved_high = Some(moves_high);
        }
        point(match f_low.abs() < f_high.abs() {
            true => low,
            false => high,
        })
    }
}

impl RootFinder {
    /// Finder for polynomials of a degree of at most 8.
    pub(super) fn new(degree: usize, max_halvings: u32) -> Self {
        let n = degree.min(MAX_DEGREE);
        let mut cos = [[0.0; MAX_COEFFICIENTS]; MAX_DEGREE + 1];
        let mut sin = cos;
        for k in 0..=n {
            // exp(ikθ) = (c + i·s)^(N + k) · (c − i·s)^(N − k) of the half angle.
            for j in 0..=2 * n {
                let (mut re, mut im) = (0.0, 0.0);
                for i in 0..=j.min(n + k) {
                    if j - i > n - k {
                        continue;
                    }
                    let size = binomial(n + k, i) * binomial(n - k, j - i);
                    match (i + 3 * (j - i)) % 4 {
                        0 => re += size,
                        1 => im += size,
                        2 => re -= size,
                        _ => im -= size,
                    }
                }
                cos[k][j] = re / binomial(2 * n, j);
                sin[k][j] = im / binomial(2 * n, j);
            }
        }
        Self {
            degree: n,
            max_halvings: max_halvings.min(MAX_HALVINGS),
            touching_halvings: None,
            cos,
            sin,
        }
    }

    /// Visits extrema near zero as well, which are pairs of complex roots: on arcs after `halvings`.
    ///
    /// The Bernstein coefficients of a polynomial of degree 16 have sign variations if the distance of such a pair from
    /// the arc's middle is less than 0.04 of the arc.
    pub(super) fn with_touching(mut self, halvings: u32) -> Self {
        self.touching_halvings = Some(halvings);
        self
    }

    /// Visits the real roots. Close roots that are not separated are visited as a root that is not simple, where the
    /// polynomial is smallest. `deviation` is the error of the coefficients, relative to the polynomial's size.
    pub(super) fn visit(
        &self,
        f: &Trigonometric,
        deviation: f64,
        mut visit: impl FnMut(AngleRoot),
    ) {
        let last = 2 * self.degree;
        let noise = deviation.max(NOISE) * f.size();
        let mut arcs = [BernsteinArc {
            coefficients: [0.0; MAX_COEFFICIENTS],
            ends: [(1.0, 0.0), (0.0, 1.0)],
            halvings: 0,
        }; MAX_ARCS];
        // The angles from 0 to π, then those from 0 to −π.
        for sign in [1.0, -1.0] {
            for (j, coefficient) in arcs[0].coefficients.iter_mut().enumerate().take(last + 1) {
                *coefficient = f.constant * self.cos[0][j];
                for (k, (a, b)) in f.harmonics().enumerate() {
                    *coefficient += a * self.cos[k + 1][j] + sign * b * self.sin[k + 1][j];
                }
            }
            arcs[0].ends = [(1.0, 0.0), (0.0, 1.0)];
            arcs[0].halvings = 0;
            let mut waiting = 1;
            while waiting > 0 {
                waiting -= 1;
                let mut arc = arcs[waiting];
                let coefficients = &mut arc.coefficients[..=last];
                let [first, second] = arc.ends;
                let at = |(c, s): (f64, f64)| Angle::of_point(c * c - s * s, 2.0 * c * s * sign);
                let signs = variations(coefficients, noise);
                let touches = self.touching_halvings == Some(arc.halvings);
                if touches
                    && matches!(signs, Variations::Unknown)
                    && let Some(half) = f.extremum(arc.ends, at)
                    && f.at(at(half)) * f.at(at(first)) > 0.0
                {
                    visit(AngleRoot {
                        angle: at(half),
                        is_simple: false,
                    });
                }
                let is_last = match signs {
                    Variations::None => continue,
                    Variations::One => {
                        visit(AngleRoot {
                            angle: f.bracketed(arc.ends, at),
                            is_simple: true,
                        });
                        continue;
                    }
                    Variations::Noise => arc.halvings >= MIN_HALVINGS.min(self.max_halvings),
                    Variations::Unknown => arc.halvings >= self.max_halvings,
                };
                if is_last {
                    let mut visit_double = |half| {
                        visit(AngleRoot {
                            angle: at(half),
                            is_simple: false,
                        });
                    };
                    arc.ends.into_iter().for_each(&mut visit_double);
                    f.extremum(arc.ends, at).into_iter().for_each(visit_double);
                    continue;
                }
                // De Casteljau's algorithm at the middle.
                let middle = (0.5 * (first.0 + second.0), 0.5 * (first.1 + second.1));
                let halvings = arc.halvings + 1;
                let near = &mut arcs[waiting + 1];
                (near.ends, near.halvings) = ([first, middle], halvings);
                for level in 0..=last {
                    near.coefficients[level] = coefficients[0];
                    for i in 0..last - level {
                        coefficients[i] = 0.5 * (coefficients[i] + coefficients[i + 1]);
                    }
                }
                (arc.ends, arc.halvings) = ([middle, second], halvings);
                arcs[waiting] = arc;
                waiting += 2;
            }
        }
    }
}

/// Sign variations of Bernstein coefficients.
enum Variations {
    None,
    One,
    /// All coefficients are noise.
    Noise,
    Unknown,
}

/// Counts the variations that are certain. One coefficient of unknown sign between opposite signs changes nothing; two
/// may hide a pair of variations.
fn variations(coefficients: &[f64], noise: f64) -> Variations {
    let (mut count, mut last, mut since_last) = (0, 0.0, 0);
    let mut hidden = 0;
    for &value in coefficients {
        if value.abs() <= noise {
            since_last += 1;
            continue;
        }
        let varies = last * value < 0.0;
        count += usize::from(varies);
        let allowed = usize::from(varies);
        hidden += since_last.max(allowed) - allowed;
        (last, since_last) = (value, 0);
    }
    hidden += since_last;
    match (count, hidden) {
        _ if last == 0.0 => Variations::Noise,
        (0, 0) => Variations::None,
        (1, 0) => Variations::One,
        _ => Variations::Unknown,
    }
}

#[cfg(test)]
#[allow(clippy::disallowed_methods, reason = "tests")]
mod tests {
    use super::{Angle, RootFinder, Trigonometric};
    use kinopt_kinematics::random::RandomStream;
    use std::f64::consts::TAU;

    const DEGREE: usize = 8;

    #[test]
    fn close_roots_are_visited_under_noise() {
        let finder = RootFinder::new(DEGREE, 8);
        for case in 0..500 {
            let mut random = RandomStream::new(8, case);
            let mut roots = [0.0; 2 * DEGREE];
            roots
                .iter_mut()
                .for_each(|root| *root = TAU * random.unit());
            // Two and three roots within 0.05 rad.
            for (root, of) in [(1, 0), (3, 2), (4, 2)] {
                roots[root] = roots[of] + 0.05 * random.unit();
            }
            let value = |angle: Angle| {
                let factors = roots.map(|root| (0.5 * (angle.radians() - root)).sin());
                factors.iter().product()
            };
            let (polynomial, _) = Trigonometric::fit(DEGREE, 0, value);
            for deviation in [0.0, 1e-9, 1e-7] {
                let mut visited = Vec::new();
                finder.visit(&polynomial, deviation, |root| visited.push(root.angle));
                for root in roots.map(Angle::of_radians) {
                    let is_visited = visited.iter().any(|angle| angle.is_within(0.02, root));
                    assert!(is_visited, "case {case}, {deviation:e}");
                }
            }
        }
    }
}
