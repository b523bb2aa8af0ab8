//! Promise: so it is for weights: given, repaired, pruned, made by distance and by heat under every option; and for volumes.
#![allow(clippy::unwrap_used)]

use glam::{DVec3, Vec3};
use kinopt::mesh::TriangleMesh;
use kinopt::skinning::{
    AutomaticWeights, HeatWeights, SkinWeights, SkinWeightsBuilder, bone_volumes,
};
use nalgebra::DMatrix;
use support::random::Random;
use support::twisted_tube::TwistedTube;

use crate::animated::{check_single, vector};
use crate::digest::{Digest, Value};

fn add(digest: &mut Digest, weights: &SkinWeights) {
    digest.debug((
        weights.vertex_count(),
        weights.bone_count(),
        weights.max_influences(),
    ));
    for row in weights.iter() {
        digest.word(row.len() as u64);
        for influence in row {
            digest.word(influence.bone.into());
            digest.doubles([influence.weight]);
        }
    }
}

/// A grid of so many squares, in the plane z = 0 or bowed.
fn sheet(squares: u32, bow: f32) -> TriangleMesh {
    let (side, place) = (squares + 1, |i: u32| i as f32 / squares as f32);
    let corners = (0..side * side).map(|k| {
        let (x, y) = (place(k % side), place(k / side));
        Vec3::new(x, 1.5 * y, bow * x * (1.0 - x))
    });
    let squares = (0..squares * squares).map(|k| (k / squares) * side + k % squares);
    let triangles = squares.flat_map(|k| [[k, k + 1, k + side], [k + 1, k + side + 1, k + side]]);
    TriangleMesh::new(corners.collect(), Vec::new(), triangles.collect()).unwrap()
}

/// Two sheets with a gap between them, the lower one's seam doubled, a needle and a flat triangle.
fn odd_mesh() -> TriangleMesh {
    let (low, mut positions) = (sheet(5, 0.4), sheet(5, 0.4).positions().to_vec());
    let mut triangles = low.triangles().to_vec();
    let count = positions.len() as u32;
    positions.extend(low.positions().iter().map(|&p| p + Vec3::Z * 0.3));
    triangles.extend(low.triangles().iter().map(|t| t.map(|k| k + count)));
    let seam = positions.len() as u32;
    positions.extend([positions[2], positions[3], Vec3::new(0.5, -0.001, 0.0)]);
    triangles.push([seam, seam + 1, seam + 2]);
    triangles.push([0, 0, 1]);
    let lone = positions.len() as u32;
    let far = Vec3::new(4.0, 0.0, 0.0);
    positions.extend([far, far + Vec3::X * 0.1, far + Vec3::Y * 0.2, far * 2.0]);
    triangles.push([lone, lone + 1, lone + 2]);
    TriangleMesh::new(positions, Vec::new(), triangles).unwrap()
}

fn bones(random: &mut Random, count: usize) -> Vec<[DVec3; 2]> {
    let mut all: Vec<[DVec3; 2]> = (0..count)
        .map(|_| [(); 2].map(|()| vector(random, 0.8).as_dvec3() + DVec3::new(0.5, 0.7, 0.1)))
        .collect();
    all[0][1] = all[0][0];
    all[2] = all[1];
    all
}

fn made() -> [Value; 2] {
    let mut random = Random::new(151);
    let (mut distance, mut heat) = (Digest::new(), Digest::new());
    let tube = TwistedTube {
        sides: 6,
        rings: 9,
        ..TwistedTube::default()
    };
    let flat = TriangleMesh::new(vec![Vec3::ONE; 3], vec![], vec![[0, 1, 2]]).unwrap();
    let nothing = TriangleMesh::default();
    for mesh in [
        odd_mesh(),
        tube.mesh().unwrap(),
        sheet(9, 0.0),
        flat,
        nothing,
    ] {
        let bones = bones(&mut random, 11);
        for (falloff, smoothing_steps, most) in
            [(4.0, 10, 8), (1.5, 0, 2), (300.0, 3, 1), (2.0, 1, 40)]
        {
            let mut by = AutomaticWeights::default();
            (by.falloff, by.smoothing_steps, by.most) = (falloff, smoothing_steps, most);
            distance.json(&by);
            add(&mut distance, &by.for_segments(&mesh, &bones).unwrap());
        }
        for (warm, most) in [(1.0, 8), (0.05, 4), (30.0, 1), (1.0, 2)] {
            let mut by = HeatWeights::default();
            (by.heat, by.most) = (warm, most);
            heat.json(&by);
            add(&mut heat, &by.for_segments(&mesh, &bones).unwrap());
        }
        let one = &bones[..1];
        add(
            &mut distance,
            &AutomaticWeights::default()
                .for_segments(&mesh, one)
                .unwrap(),
        );
        add(
            &mut heat,
            &HeatWeights::default().for_segments(&mesh, one).unwrap(),
        );
    }
    // A piece of skin that sees no bone, as the tube around them hides it.
    let hidden = tube.mesh().unwrap();
    let mut positions = hidden.positions().to_vec();
    let mut triangles = hidden.triangles().to_vec();
    let count = positions.len() as u32;
    positions.extend([[3.0, 2.0, 0.1], [3.5, 2.0, 0.3], [5.0, 2.5, 0.2]].map(Vec3::from));
    triangles.push([count, count + 1, count + 2]);
    let hidden = TriangleMesh::new(positions, Vec::new(), triangles).unwrap();
    let inside = [[1.0, 3.0], [4.5, 7.0]].map(|x| x.map(|x| DVec3::new(x, 0.05, 0.02)));
    for warm in [1.0, 0.01] {
        let mut by = HeatWeights::default();
        by.heat = warm;
        add(&mut heat, &by.for_segments(&hidden, &inside).unwrap());
    }
    let mesh = sheet(2, 0.0);
    let mut some = bones(&mut random, 4);
    let mut by = AutomaticWeights::default();
    distance.refused(by.for_segments(&mesh, &[]));
    heat.refused(HeatWeights::default().for_segments(&mesh, &[]));
    for falloff in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        by.falloff = falloff;
        distance.refused(by.for_segments(&mesh, &some));
        let mut by = HeatWeights::default();
        by.heat = falloff;
        heat.refused(by.for_segments(&mesh, &some));
    }
    by.most = 0;
    distance.refused(by.for_segments(&mesh, &some));
    some[3][1].y = f64::NAN;
    by = AutomaticWeights::default();
    distance.refused(by.for_segments(&mesh, &some));
    heat.refused(HeatWeights::default().for_segments(&mesh, &some));
    [distance.value(), heat.value()]
}

/// Weights of random sizes that sum to 1, some below 0.
fn given(random: &mut Random, vertices: usize, bones: usize) -> DMatrix<f64> {
    let mut table = DMatrix::from_fn(vertices, bones, |row, column| match (row + column) % 3 {
        0 => 0.0,
        _ => random.unit(),
    });
    for mut row in table.row_iter_mut() {
        let sum = row.sum();
        row /= sum;
    }
    table[(1, 0)] -= 0.004;
    table[(1, 2)] += 0.004;
    table
}

fn kept() -> Value {
    let (mut digest, mut random) = (Digest::new(), Random::new(152));
    let table = given(&mut random, 7, 9);
    let weights = SkinWeights::from_table(&table).unwrap();
    add(&mut digest, &weights);
    digest.doubles(weights.to_table().iter().copied());
    digest.debug((weights.influences(2), weights.influences(7)));
    for most in [1, 2, 4, 6, 20] {
        let (pruned, told) = weights.pruned(most).unwrap();
        add(&mut digest, &pruned);
        digest.debug(told);
    }
    digest.refused(weights.pruned(0));
    let none = SkinWeights::builder(0, 2).build().unwrap();
    digest.debug(none.pruned(3).unwrap());
    let build = |triples: &[(usize, usize, f64)]| {
        let mut builder = SkinWeights::builder(2, 3);
        for &(vertex, bone, weight) in triples {
            builder.add(vertex, bone, weight).unwrap();
        }
        builder
    };
    for triples in [
        vec![(1, 2, 0.5), (1, 0, 0.5), (0, 1, 1.0)],
        vec![(0, 0, 2.0), (0, 1, -0.5), (1, 1, 0.25), (1, 2, 0.5)],
        vec![(0, 0, 1.0), (1, 1, 1.5), (1, 2, 0.0)],
        vec![(0, 0, 1.0)],
        vec![(0, 0, 1.0), (1, 1, -1.0)],
        vec![(0, 0, 1.0), (1, 1, 0.5), (1, 1, 0.5)],
        vec![(0, 0, 1.02), (0, 1, -0.02), (1, 2, 1.0)],
        vec![(0, 0, f64::MAX), (0, 1, f64::MAX), (1, 2, 1.0)],
    ] {
        let told = |built: Result<SkinWeights, _>, digest: &mut Digest| match built {
            Ok(weights) => add(digest, &weights),
            Err(error) => {
                let error: kinopt::skinning::SkinningError = error;
                digest.text(error.to_string());
            }
        };
        told(build(&triples).build(), &mut digest);
        match build(&triples).build_repaired() {
            Ok((weights, repair)) => {
                add(&mut digest, &weights);
                digest.debug((&repair, repair.is_empty()));
            }
            Err(error) => digest.text(error.to_string()),
        }
    }
    let builder = || -> SkinWeightsBuilder { SkinWeights::builder(2, 3) };
    digest.refused(builder().add(2, 0, 1.0));
    digest.refused(builder().add(0, 3, 1.0));
    digest.refused(builder().add(0, 1, f64::NAN));
    digest.value()
}

fn volumes() -> Value {
    let mut digest = Digest::new();
    let tube = TwistedTube {
        sides: 7,
        rings: 6,
        radius: 0.6,
        length: 2.5,
        ..TwistedTube::default()
    };
    let (tube, weights) = (tube.mesh().unwrap(), tube.weights().unwrap());
    // Along each axis, inside out, and without its last triangle.
    let turned = |turn: fn(Vec3) -> Vec3, mirror: bool, left_out: usize| {
        let positions = tube.positions().iter().map(|&p| turn(p)).collect();
        let corners = tube.triangles().iter().skip(left_out);
        let corners = corners.map(|&[a, b, c]| if mirror { [a, c, b] } else { [a, b, c] });
        TriangleMesh::new(positions, Vec::new(), corners.collect()).unwrap()
    };
    for mesh in [
        turned(|p| p, false, 0),
        turned(|p| Vec3::new(p.y, p.z * 0.5, p.x), false, 0),
        turned(|p| Vec3::new(p.z, p.x, p.y * 0.25), false, 0),
        turned(|p| p - 3.0, true, 0),
        turned(|p| p, false, 30),
    ] {
        match bone_volumes(&mesh, &weights) {
            Ok(volumes) => {
                for own in volumes {
                    digest.doubles([own.volume]);
                    digest.doubles(own.centre.to_array());
                }
            }
            Err(error) => digest.text(error.to_string()),
        }
    }
    digest.refused(bone_volumes(&TriangleMesh::default(), &weights));
    let none = SkinWeights::builder(0, 2).build().unwrap();
    digest.refused(bone_volumes(&TriangleMesh::default(), &none));
    let flat = sheet(2, 0.0);
    let whole = AutomaticWeights::default().for_segments(&flat, &[[DVec3::ZERO, DVec3::X]]);
    digest.refused(bone_volumes(&flat, &whole.unwrap()));
    digest.value()
}

#[test]
fn of_weights() {
    let [distance, heat] = made();
    check_single(&[
        ("weights by distance under every option", distance),
        ("weights by heat under every option", heat),
        ("weights, kept and repaired", kept()),
        ("volumes of tubes", volumes()),
    ]);
}
