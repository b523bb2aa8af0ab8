//! Promise: an end effector follows a viewing ray, by its distance from the line or its distance in the image. Pinned
//! tips stay at rest.

use kinopt::Solver;
use kinopt::problem::{Evaluation, Problem};
use kinopt::solver::LeastSquares;
use kinopt::task::{Camera, Pixel, Point, Ray};
use nalgebra as na;
use support::bones::RandomRig;
use support::random::Random;
use support::trees::configuration_of;
use support::{placement, rigid};

type Vector = na::Vector3<f64>;

/// The usual form of the energy: ‖(x − m) − ((x − m)·d) d‖² with d = (e − m)/‖e − m‖.
fn mouse_energy(x: Vector, eye: Vector, mouse: Vector) -> f64 {
    let d = (eye - mouse) / (eye - mouse).norm();
    ((x - mouse) - d * (x - mouse).dot(&d)).norm_squared()
}

#[test]
fn ray_energy_equals_both_formulas() {
    for seed in 0..10 {
        let rig = RandomRig::new(seed);
        let mut random = Random::new(seed);
        let q = configuration_of(rig.skeleton.model(), &mut random);
        let tip = rig.tips[0];
        let x = rig.tip(&rig.transforms(&q), tip);
        let (eye, mouse) = (random.vector(3.0), random.vector(1.0));
        let d = (eye - mouse).normalize();
        // Any other point of the line gives the same energy, from either side.
        for (eye, mouse) in [(eye, mouse), (eye, mouse + d * 0.3), (mouse - d, mouse)] {
            let mut builder = Problem::builder(rig.skeleton.model());
            builder.add(Ray::new(rig.skeleton.tip(tip), eye, mouse));
            let problem = builder.build().unwrap();
            let mut scratch = problem.scratch();
            let mut evaluation = Evaluation::new(&problem, &mut scratch);
            let mut r = [0.0; 3];
            let leaders = problem.parameters().leaders();
            let angles: Vec<f64> = leaders.iter().map(|&k| q[k]).collect();
            evaluation.residual(&angles, &mut r);
            let energy: f64 = r.iter().map(|r| r * r).sum();
            let expected = mouse_energy(x, eye, mouse);
            assert!((energy - expected).abs() < 1e-13 * (1.0 + expected));
            // m and e do not depend on x: ‖(x − m) × d‖².
            let short = (x - mouse).cross(&d).norm_squared();
            assert!((energy - short).abs() < 1e-13 * (1.0 + short));
        }
    }
}

/// A camera that looks at the rig, and the ray through one of its pixels.
struct View {
    camera: Camera,
    eye: Vector,
    world_from_camera: support::Rigid,
}

const FOCAL: f64 = 600.0;
const CENTRE: [f64; 2] = [320.0, 240.0];

impl View {
    fn new(at: Vector, random: &mut Random) -> Self {
        let eye = at + random.direction().into_inner() * 4.0;
        let up = Vector::new(0.1, 0.2, 1.0);
        let facing = na::Rotation3::face_towards(&(at - eye), &up);
        let world_from_camera = rigid(facing, eye);
        let camera = Camera::pinhole(&placement(&world_from_camera), [FOCAL; 2], CENTRE);
        Self {
            camera,
            eye,
            world_from_camera,
        }
    }

    /// The pixel on the screen, in scene coordinates.
    fn unproject(&self, [u, v]: [f64; 2]) -> Vector {
        let on_screen = na::Point3::new((u - CENTRE[0]) / FOCAL, (v - CENTRE[1]) / FOCAL, 1.0);
        (self.world_from_camera * on_screen).coords
    }
}

/// Result of a drag of one tip to the ray, with the others pinned at rest.
fn dragged(rig: &RandomRig, view: &View, pixel: [f64; 2], in_image: bool) -> Vec<f64> {
    let mut builder = Problem::builder(rig.skeleton.model());
    let tip = rig.skeleton.tip(rig.tips[0]);
    if in_image {
        builder.add(Pixel::new(tip, view.camera, pixel));
    } else {
        let [eye, mouse] = view.camera.viewing_ray(pixel).unwrap();
        builder.add(Ray::new(tip, eye, mouse));
    }
    let rest = rig.transforms(&vec![0.0; rig.skeleton.angles()]);
    for &other in &rig.tips[1..] {
        builder.add(Point::new(rig.skeleton.tip(other), rig.tip(&rest, other)));
    }
    let problem = builder.build().unwrap();
    let start = rig.skeleton.model().neutral();
    let solution = Solver::default().solve_once(&problem, &start).unwrap();
    assert!(
        solution.reached,
        "in the image: {in_image}\n{}",
        solution.explain()
    );
    solution.q
}

#[test]
fn viewing_ray_passes_through_the_pixel() {
    let mut random = Random::new(9);
    for _ in 0..50 {
        let view = View::new(random.vector(2.0), &mut random);
        let pixel = [random.within(0.0, 640.0), random.within(0.0, 480.0)];
        let [eye, mouse] = view.camera.viewing_ray(pixel).unwrap();
        assert!((Vector::from(eye) - view.eye).amax() < 1e-13);
        assert!((Vector::from(mouse) - view.unproject(pixel)).amax() < 1e-13);
        // Every point of the ray projects to its pixel, at any distance.
        for depth in [0.1, 1.0, 70.0] {
            let seen = view.camera.project(eye + (mouse - eye) * depth);
            for (seen, expected) in seen.iter().zip(pixel) {
                assert!((seen - expected).abs() < 1e-9, "{seen} {expected}");
            }
        }
    }
    // Parallel rays have no eye.
    let parallel = Camera {
        pixel_from_world: [
            [1.0, 0.0, 0.0, 5.0],
            [0.0, 1.0, 0.0, 6.0],
            [0.0, 0.0, 0.0, 1.0],
        ],
    };
    assert_eq!(parallel.viewing_ray([1.0, 2.0]), None);
    assert_eq!(
        View::new(Vector::x(), &mut random)
            .camera
            .viewing_ray([f64::NAN, 0.0]),
        None
    );
}

#[test]
fn one_tip_follows_the_ray_and_others_stay() {
    for seed in 0..8 {
        let rig = RandomRig::new(seed);
        let mut random = Random::new(100 + seed);
        let rest = rig.transforms(&vec![0.0; rig.skeleton.angles()]);
        // An independent limb bends: its tip's target is reachable with the others at rest.
        let mut bent = vec![0.0; rig.skeleton.angles()];
        let mut bone = Some(rig.tips[0].index());
        for _ in 0..2 {
            let Some(index) = bone else { break };
            for (k, limits) in rig.skeleton.bones()[index].limits.iter().enumerate() {
                bent[3 * index + k] = limits.clamp(random.within(-0.6, 0.6));
            }
            bone = rig.parents[index];
        }
        let target = rig.tip(&rig.transforms(&bent), rig.tips[0]);
        let view = View::new(target, &mut random);
        let [u, v] = view.camera.project(target.into());
        let mouse = view.unproject([u, v]);
        assert!(mouse_energy(target, view.eye, mouse) < 1e-24);
        for in_image in [false, true] {
            let q = dragged(&rig, &view, [u, v], in_image);
            let posed = rig.transforms(&q);
            let off = mouse_energy(rig.tip(&posed, rig.tips[0]), view.eye, mouse).sqrt();
            assert!(
                off < 1e-4,
                "rig {seed}, in the image: {in_image}: {off:e} off the ray"
            );
            for &other in &rig.tips[1..] {
                let moved = (rig.tip(&posed, other) - rig.tip(&rest, other)).norm();
                assert!(moved < 1e-4, "rig {seed}: a pinned tip moved by {moved:e}");
            }
        }
    }
}
