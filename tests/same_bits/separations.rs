//! Promise: so it is for shapes by themselves: what is around them, how far a place is from them, what stands in one line or
//! in one place with another, what files of meshes hold, what is refused and what is only noted.
#![allow(clippy::unwrap_used)]

use kinopt::collision::{MeshFile, Shape, ShapeKind, World, separation, separation_within};
use kinopt::robot::Geometry;
use kinopt::spatial::{Placement, Vector3};
use support::box_sides::box_triangles;
use support::random::Random;

use crate::arms::turned;
use crate::digest::{Digest, Value, check};
use crate::worlds::vector;

/// Corners of a block from `low` to `high`, and its sides wound outwards.
fn block(low: [f64; 3], high: [f64; 3]) -> (Vec<Vector3<f64>>, Vec<[u32; 3]>) {
    let corner = |k: usize| {
        let pick = |axis: usize| [low, high][k >> axis & 1][axis];
        Vector3::new(pick(0), pick(1), pick(2))
    };
    ((0..8).map(corner).collect(), box_triangles())
}

/// One of every kind, slender, flat and long ones with them.
fn shapes(random: &mut Random) -> Vec<Shape> {
    let cloud: Vec<_> = (0..9).map(|_| vector(random, 0.6)).collect();
    let (corners, faces) = block([-0.2, -0.3, -0.1], [0.3, 0.3, 0.2]);
    let heights = (0..20).map(|_| random.within(-0.2, 0.3)).collect();
    let turned_out: Vec<_> = faces.iter().map(|[a, b, c]| [*a, *c, *b]).collect();
    let prism = [
        [0.0, 0.0],
        [0.4, 0.0],
        [0.5, 0.3],
        [0.2, 0.5],
        [-0.1, 0.2],
        [0.2, 0.0],
    ];
    let prism = prism
        .iter()
        .flat_map(|&[x, y]| [-0.2, 0.25].map(|z| Vector3::new(x, y, z)));
    [
        Shape::sphere(0.3),
        Shape::capsule(0.1, 0.7),
        Shape::capsule(0.2, 1e-3),
        Shape::cylinder(0.25, 0.5),
        Shape::cylinder(0.4, 0.01),
        Shape::cuboid([0.3, 0.5, 0.2]),
        Shape::cuboid([1.5, 1e-3, 0.6]),
        Shape::ellipsoid([0.2, 0.35, 0.1]),
        Shape::convex(&cloud),
        Shape::convex(&prism.collect::<Vec<_>>()),
        Shape::mesh(corners.clone(), faces),
        Shape::mesh(corners.clone(), turned_out[..7].to_vec()),
        Shape::mesh(corners, turned_out),
        Shape::height_field(heights, 5, [0.2, 0.3]),
        Shape::points(cloud, 0.05),
    ]
    .into_iter()
    .map(Result::unwrap)
    .chain([Shape::half_space()])
    .collect()
}

fn around() -> Value {
    let (mut digest, mut random) = (Digest::new(), Random::new(51));
    for shape in shapes(&mut random) {
        let scaled = shape.scaled(2.5).unwrap();
        for shape in [shape, scaled] {
            let place = Placement::new(turned(|| random.unit()), vector(&mut random, 1.0));
            for bounds in [shape.bounding_box(), shape.bounding_box().placed(&place)] {
                digest.doubles(bounds.min.to_array());
                digest.doubles(bounds.max.to_array());
            }
            let ball = shape.bounding_sphere();
            digest.doubles(ball.centre.to_array());
            digest.doubles([ball.radius]);
            for _ in 0..20 {
                digest.doubles([shape.signed_distance(vector(&mut random, 1.2))]);
            }
            digest.doubles([shape.signed_distance(Vector3::zero())]);
            digest.doubles([shape.signed_distance(ball.centre)]);
            match shape.kind() {
                ShapeKind::Convex(hull) => {
                    digest.doubles(hull.vertices().iter().flat_map(|v| v.to_array()));
                }
                ShapeKind::Mesh(mesh) => {
                    digest.word(mesh.is_closed().into());
                    digest.doubles(mesh.vertices().iter().flat_map(|v| v.to_array()));
                    digest.bytes(format!("{:?} {:?}", mesh.triangles(), shape.notes()));
                }
                ShapeKind::HeightField(field) => {
                    digest.doubles(field.heights().iter().copied().chain(field.spacing()));
                    digest.bytes(format!("{} {}", field.rows(), field.columns()));
                }
                kind => digest.bytes(format!("{kind:?}")),
            }
        }
    }
    digest.value()
}

/// Where directions are many or none: one place, one axis, faces on faces, tiny turns, and far away.
fn in_line() -> Value {
    let (mut digest, mut random) = (Digest::new(), Random::new(52));
    let all = shapes(&mut random);
    let quarter = turned_about_x();
    let tilt = Placement::new(turned(|| random.unit()), Vector3::zero());
    let ways = [
        Placement::identity(),
        Placement::translation(Vector3::new(0.0, 0.0, 0.45)),
        Placement::translation(Vector3::new(0.5, 0.0, 0.0)),
        Placement::new(quarter, Vector3::new(0.0, 0.3, 0.0)),
        Placement::translation(Vector3::new(0.0, -40.0, 3.0)),
    ];
    for (k, first) in all.iter().enumerate() {
        for second in &all[k..] {
            for way in ways {
                let [at_first, at_second] = [tilt, tilt * way];
                let found = separation(first, &at_first, second, &at_second);
                digest.doubles([found.distance]);
                digest.doubles(found.normal.to_array());
                digest.doubles((found.on_second - found.on_first).to_array());
                for within in [-0.01, 0.0, 0.3] {
                    let near = separation_within(second, &at_second, first, &at_first, within);
                    digest.doubles(near.map(|near| near.distance));
                }
            }
        }
    }
    digest.value()
}

/// A quarter of a turn about x.
fn turned_about_x() -> kinopt::spatial::Matrix3<f64> {
    let [x, y, z] = Vector3::UNITS;
    kinopt::spatial::Matrix3::from_columns(x, z, -y)
}

/// How high things stand over a place, along upright and other ways.
fn tops() -> Value {
    let (mut digest, mut random) = (Digest::new(), Random::new(53));
    let mut world = World::new();
    for (k, shape) in shapes(&mut random).into_iter().enumerate() {
        let place = Placement::new(turned(|| random.unit()), vector(&mut random, 1.0));
        world.add(&format!("{k}"), shape, place).unwrap();
    }
    world.attach("0", "hand", Placement::identity()).unwrap();
    for _ in 0..2 {
        for _ in 0..6 {
            let up = turned(|| random.unit()).z;
            for up in [up, Vector3::UNITS[2], Vector3::UNITS[0]] {
                let top = world.height_at(vector(&mut random, 1.0), up);
                digest.doubles([top.unwrap_or(-99.0)]);
            }
        }
        world.remove("15").unwrap();
        world
            .add("15", Shape::sphere(0.1).unwrap(), Vector3::zero())
            .unwrap();
    }
    digest.value()
}

fn told<T, E: ToString>(digest: &mut Digest, found: Result<T, E>, notes: impl Fn(&T) -> String) {
    digest.bytes(match found {
        Ok(taken) => notes(&taken),
        Err(error) => error.to_string(),
    });
}

fn refusals() -> Value {
    let mut digest = Digest::new();
    let notes = |shape: &Shape| {
        let notes = shape.notes().iter().map(ToString::to_string);
        notes.collect::<Vec<_>>().join("; ")
    };
    for x in [0.0, -0.1, f64::NAN, f64::INFINITY, 9e-10, 1e-9, 1e9, 1.1e9] {
        told(&mut digest, Shape::sphere(x), notes);
        told(&mut digest, Shape::capsule(1.0, x), notes);
        told(&mut digest, Shape::capsule(x, 0.1), notes);
        told(&mut digest, Shape::cylinder(1.0, x), notes);
        told(&mut digest, Shape::cylinder(x, 0.1), notes);
        for axis in 0..3 {
            let mut size = [0.3, 2.0, 1.0];
            size[axis] = x;
            told(&mut digest, Shape::cuboid(size), notes);
            told(&mut digest, Shape::ellipsoid(size), notes);
        }
        told(&mut digest, Shape::points(vec![Vector3::zero()], x), notes);
        let field = |spacing| Shape::height_field(vec![0.0; 6], 3, spacing);
        told(&mut digest, field([x, 1.0]), notes);
        told(&mut digest, field([1.0, x]), notes);
        told(&mut digest, Shape::sphere(2.0).unwrap().scaled(x), notes);
        let corner = Vector3::new(0.1, x, 0.0);
        told(
            &mut digest,
            Shape::points(vec![Vector3::zero(), corner], 0.1),
            notes,
        );
        let hull = [
            Vector3::zero(),
            Vector3::UNITS[0],
            Vector3::UNITS[2],
            corner,
        ];
        told(&mut digest, Shape::convex(&hull), notes);
        told(
            &mut digest,
            Shape::mesh(hull.to_vec(), vec![[0, 1, 2]]),
            notes,
        );
        told(
            &mut digest,
            Shape::height_field(vec![0.0, 1.0, x, 2.0], 2, [1.0; 2]),
            notes,
        );
    }
    told(&mut digest, Shape::points(Vec::new(), 0.1), notes);
    for (heights, columns) in [(6, 0), (6, 1), (6, 4), (3, 3), (0, 2), (4, 2)] {
        told(
            &mut digest,
            Shape::height_field(vec![0.5; heights], columns, [1.0; 2]),
            notes,
        );
    }
    for count in 0..5_u32 {
        let flat: Vec<_> = (0..count)
            .map(|k| Vector3::new(f64::from(k), f64::from(k * k), 0.0))
            .collect();
        told(&mut digest, Shape::convex(&flat), notes);
    }
    let (corners, faces) = block([0.0; 3], [1.0, 2.0, 1.0]);
    let mut meshes = vec![
        (corners.clone(), Vec::new()),
        (corners.clone(), vec![[0, 1, 8]]),
        (corners.clone(), vec![[0, 1, 1]]),
        (corners.clone(), faces[1..].to_vec()),
        (corners.clone(), faces[2..].to_vec()),
    ];
    let mut wound = faces.clone();
    wound[3].swap(0, 1);
    meshes.push((corners.clone(), wound));
    let mut flat = faces.clone();
    flat.extend([[0, 0, 1], [2, 2, 2]]);
    meshes.push((corners.clone(), flat));
    // Each triangle with corners of its own, at one place, and beside one another.
    for beside in [0.0, 1e-7, 1e-3] {
        let apart = |(k, corner): (usize, &u32)| {
            corners[*corner as usize] + Vector3::UNITS[k % 3] * (beside * (k % 2) as f64)
        };
        let all = faces.iter().flatten().enumerate().map(apart).collect();
        let own = (0..faces.len() as u32).map(|k| [3 * k, 3 * k + 1, 3 * k + 2]);
        meshes.push((all, own.collect()));
    }
    for (corners, faces) in meshes {
        told(&mut digest, Shape::mesh(corners, faces), notes);
    }
    let mesh = Geometry::Mesh {
        file: "hand.stl".into(),
        scale: [1.0; 3],
    };
    let described = [
        mesh,
        Geometry::Box {
            size: [0.1, 0.2, -0.3],
        },
        Geometry::Ellipsoid {
            radii: [0.1, 0.2, 0.3],
        },
    ];
    for geometry in described {
        told(&mut digest, Shape::try_from(&geometry), |shape| {
            format!("{:?}", shape.bounding_box())
        });
    }
    digest.value()
}

/// Binary STL of triangles.
fn stl(triangles: &[[[f32; 3]; 3]]) -> Vec<u8> {
    let mut bytes = b"solid but binary".to_vec();
    bytes.resize(80, 0);
    bytes.extend((triangles.len() as u32).to_le_bytes());
    for corners in triangles {
        bytes.extend([0; 12]);
        bytes.extend(corners.as_flattened().iter().flat_map(|x| x.to_le_bytes()));
        bytes.extend([0; 2]);
    }
    bytes
}

const OBJ: &str = "# two parts\nv 0 0 0\nv 1 0 0\nv 1 1 0.5\nv 0 1 0\nf 1/1/1 2//2 3/3 4\nv 5 0 0\nv 6 0 0\nv 5 1 0\nf -3 -2 -1\n";

fn dae(nodes: &str) -> String {
    format!(
        r##"<COLLADA><asset><unit meter="0.01"/></asset><library_geometries><geometry id="g"><mesh>
        <source id="s"><float_array>0 0 0 9 1 0 0 9 0 1 0 9 0 0 1 9 1 1 1 9</float_array>
        <technique_common><accessor stride="4"/></technique_common></source>
        <vertices id="v"><input semantic="POSITION" source="#s"/></vertices>
        <triangles><input semantic="NORMAL" source="#s" offset="1"/><input semantic="VERTEX" source="#v" offset="0"/>
        <p>0 0 1 1 2 2</p><p>1 0 2 0 3 0</p></triangles>
        <polylist><input semantic="VERTEX" source="#v"/><vcount>3 4</vcount><p>0 1 2 0 1 4 3</p></polylist>
        <tristrips><input semantic="VERTEX" source="#v"/><p>0 1 2 3 4</p></tristrips>
        <trifans><input semantic="VERTEX" source="#v"/><p>0 1 2 3</p></trifans></mesh></geometry></library_geometries>
        <library_nodes><node id="n"><translate>0 0 3</translate><instance_geometry url="#g"/></node></library_nodes>
        <library_visual_scenes><visual_scene id="a"><node>{nodes}</node></visual_scene></library_visual_scenes></COLLADA>"##
    )
}

fn files() -> Value {
    let mut digest = Digest::new();
    let [a, b, c, d] = [
        [0.0, 0.0, 0.0],
        [0.1, 0.0, 0.0],
        [0.0, 0.2, 0.0],
        [0.0, 0.0, 0.3],
    ];
    let plain = stl(&[[a, b, c], [a, c, d], [a, d, b]]);
    let text = "solid x\nfacet\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1e-1 0\nendloop\nendfacet\nouter loop\nvertex 0 0 0\nvertex 0 1e-1 0\nvertex 0 0 7\nendloop\nendsolid\n";
    let placed = "<matrix>0 -2 0 1 1 0 0 2 0 0 1 3 0 0 0 1</matrix><instance_geometry url='#g'/>";
    let nested = "<rotate>0 0 3 90</rotate><node><scale>1 -1 2</scale><translate>1 2 3</translate><instance_geometry url='#g'/></node><instance_node url='#n'/>";
    let mut all: Vec<(&str, Vec<u8>)> = vec![
        ("a.obj", OBJ.into()),
        ("a.stl", plain.clone()),
        ("b.stl", text.into()),
        ("a.dae", dae(placed).into()),
        ("b.dae", dae(nested).into()),
    ];
    // What is wrong with them.
    all.push(("c.stl", plain[..plain.len() - 1].to_vec()));
    all.push(("d.stl", [&plain[..], &[1, 2]].concat()));
    all.push(("e.stl", stl(&[[a, [f32::NAN, 0.0, 0.0], c]])));
    all.push(("f.stl", b"no".to_vec()));
    for (from, to) in [
        ("endloop", ""),
        ("vertex 1 0 0", "vertex 1 0 x"),
        ("vertex 1 0 0", ""),
    ] {
        all.push(("g.stl", text.replacen(from, to, 1).into()));
    }
    for (from, to) in [
        ("-3", "-8"),
        ("2//2", "9"),
        ("2//2", "0"),
        ("v 1 0 0", "v 1 0"),
        ("6 0 0", "6 0 nan"),
        ("f -3 -2 -1", "f -3 -2"),
    ] {
        all.push(("b.obj", OBJ.replacen(from, to, 1).into()));
    }
    for (from, to) in [
        ("<vcount>3 4", "<vcount>3 5"),
        ("offset=\"1\"", "offset=\"64\""),
        ("offset=\"1\"", "offset=\"x\""),
        ("stride=\"4\"", "stride=\"2\""),
        ("stride=\"4\"", ""),
        ("<p>1 0 2", "<p>1 0 7"),
        ("source=\"#v\"", "source=\"#w\""),
        ("semantic=\"POSITION\"", ""),
        ("float_array", "int_array"),
        ("9 1 0 0", "9 1 0 o"),
        ("0.01", "-1"),
        ("<matrix>0 -2", "<matrix>0"),
        ("<matrix>", "<lookat/><matrix>"),
        ("url='#g'", "url='#h'"),
        ("COLLADA>", "C>"),
    ] {
        all.push(("c.dae", dae(placed).replace(from, to).into()));
    }
    all.push(("a.x", OBJ.into()));
    for (name, bytes) in all {
        match MeshFile::parse(&bytes, name) {
            Ok(mesh) => {
                for mesh in mesh
                    .parts()
                    .into_iter()
                    .chain([mesh.scaled([2.0, -1.0, 0.5])])
                {
                    digest.doubles(mesh.points.iter().flat_map(|p| p.to_array()));
                    digest.bytes(format!("{:?}", mesh.triangles));
                }
            }
            Err(error) => digest.text(error.to_string()),
        }
    }
    digest.value()
}

#[test]
fn of_what_is_around_shapes() {
    check(&[("what is around shapes", around())]);
}

#[test]
fn of_shapes_in_line() {
    check(&[("distances where directions are many or none", in_line())]);
}

#[test]
fn of_heights_over_a_place() {
    check(&[("heights of a world over a place", tops())]);
}

#[test]
fn of_refused_shapes() {
    check(&[("refused and noted shapes", refusals())]);
}

#[test]
fn of_mesh_files() {
    check(&[("shapes of meshes' files", files())]);
}
