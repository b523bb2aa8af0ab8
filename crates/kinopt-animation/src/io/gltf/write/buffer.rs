//! The glTF document under construction, and its binary chunk.

use std::collections::BTreeMap;

use gltf_json::accessor::{ComponentType, GenericComponentType, IndexComponentType, Type, sparse};
use gltf_json::buffer::{Buffer, Target, View};
use gltf_json::validation::{Checked, USize64};
use gltf_json::{Accessor, Index, Root, Value};

use super::UnwritableScene;
use crate::io::gltf::glb;

/// A document and its only buffer.
pub(super) struct Document {
    pub(super) root: Root,
    bytes: Vec<u8>,
    /// Accessors of key times by bit pattern: most channels share their times.
    times: BTreeMap<Vec<u32>, Index<Accessor>>,
}

/// Type and size of an accessor.
struct AccessorType {
    kind: Type,
    component: ComponentType,
    count: usize,
    bounds: Option<[Value; 2]>,
}

impl Document {
    pub(super) fn new() -> Self {
        let mut root = Root::default();
        root.asset.generator = Some(concat!("kinopt ", env!("CARGO_PKG_VERSION")).into());
        Self {
            root,
            bytes: Vec::new(),
            times: BTreeMap::new(),
        }
    }

    /// Adds vectors or single numbers. `bounded` adds their minimum and maximum, which positions and key times require.
    pub(super) fn numbers<const N: usize>(
        &mut self,
        values: &[[f32; N]],
        bounded: bool,
        target: Option<Target>,
    ) -> Index<Accessor> {
        let view = self.view(bytemuck::cast_slice(values.as_flattened()), target);
        self.accessor(
            Some(view),
            AccessorType {
                kind: kind::<N>(),
                component: ComponentType::F32,
                count: values.len(),
                bounds: bounded.then(|| bounds(values.iter())),
            },
            None,
        )
    }

    /// Adds key times, or returns the accessor of equal times.
    pub(super) fn times(&mut self, times: &[f32]) -> Index<Accessor> {
        let bits: Vec<u32> = times.iter().map(|time| time.to_bits()).collect();
        if let Some(known) = self.times.get(&bits) {
            return *known;
        }
        let values: Vec<[f32; 1]> = times.iter().map(|&time| [time]).collect();
        let index = self.numbers(&values, true, None);
        self.times.insert(bits, index);
        index
    }

    /// Adds triangle indices.
    pub(super) fn triangles(&mut self, triangles: &[[u32; 3]]) -> Index<Accessor> {
        let corners = triangles.as_flattened();
        let view = self.view(
            bytemuck::cast_slice(corners),
            Some(Target::ElementArrayBuffer),
        );
        self.integers(view, Type::Scalar, ComponentType::U32, corners.len())
    }

    /// Adds four joint indices per vertex.
    pub(super) fn joints(&mut self, joints: &[[u16; 4]]) -> Index<Accessor> {
        let bytes = bytemuck::cast_slice(joints.as_flattened());
        let view = self.view(bytes, Some(Target::ArrayBuffer));
        self.integers(view, Type::Vec4, ComponentType::U16, joints.len())
    }

    fn integers(
        &mut self,
        view: Index<View>,
        kind: Type,
        component: ComponentType,
        count: usize,
    ) -> Index<Accessor> {
        let shape = AccessorType {
            kind,
            component,
            count,
            bounds: None,
        };
        self.accessor(Some(view), shape, None)
    }

    /// Adds differences at some of `count` vertices; others are 0. The accessor is sparse, unless all vertices have
    /// non-zero differences.
    pub(super) fn deltas(
        &mut self,
        count: usize,
        vertices: &[u32],
        deltas: &[[f32; 3]],
        bounded: bool,
    ) -> Index<Accessor> {
        if vertices.len() == count && deltas.iter().all(|delta| *delta != [0.0; 3]) {
            return self.numbers(deltas, bounded, Some(Target::ArrayBuffer));
        }
        let zero = [[0.0; 3]];
        let rest = zero.iter().filter(|_| vertices.len() < count);
        let shape = AccessorType {
            kind: Type::Vec3,
            component: ComponentType::F32,
            count,
            bounds: bounded.then(|| bounds(deltas.iter().chain(rest))),
        };
        if vertices.is_empty() {
            return self.accessor(None, shape, None);
        }
        let indices = self.view(bytemuck::cast_slice(vertices), None);
        let values = self.view(bytemuck::cast_slice(deltas.as_flattened()), None);
        let sparse = plain!(sparse::Sparse {
            count: vertices.len().into(),
            indices: plain!(sparse::Indices {
                buffer_view: indices,
                byte_offset: USize64(0),
                component_type: Checked::Valid(IndexComponentType(ComponentType::U32)),
            }),
            values: plain!(sparse::Values {
                buffer_view: values,
                byte_offset: USize64(0),
            }),
        });
        self.accessor(None, shape, Some(sparse))
    }

    fn accessor(
        &mut self,
        view: Option<Index<View>>,
        shape: AccessorType,
        sparse: Option<sparse::Sparse>,
    ) -> Index<Accessor> {
        let [min, max] = match shape.bounds {
            Some([min, max]) => [Some(min), Some(max)],
            None => [None, None],
        };
        self.root.push(plain!(Accessor {
            buffer_view: view,
            byte_offset: None,
            count: shape.count.into(),
            component_type: Checked::Valid(GenericComponentType(shape.component)),
            type_: Checked::Valid(shape.kind),
            min,
            max,
            name: None,
            normalized: false,
            sparse,
        }))
    }

    fn view(&mut self, bytes: &[u8], target: Option<Target>) -> Index<View> {
        // Entries are multiples of four bytes, so every view starts at a multiple.
        let offset = self.bytes.len();
        self.bytes.extend_from_slice(bytes);
        self.root.push(plain!(View {
            buffer: Index::new(0),
            byte_length: bytes.len().into(),
            byte_offset: Some(offset.into()),
            byte_stride: None,
            name: None,
            target: target.map(Checked::Valid),
        }))
    }

    /// The document without its buffer, and the buffer.
    pub(super) fn into_parts(self) -> (Root, Vec<u8>) {
        (self.root, self.bytes)
    }

    /// The document as GLB.
    pub(super) fn finish(mut self) -> Result<Vec<u8>, UnwritableScene> {
        if !self.bytes.is_empty() {
            self.root.push(plain!(Buffer {
                byte_length: self.bytes.len().into(),
                name: None,
                uri: None,
            }));
        }
        let json = self.root.to_vec();
        let json = json.map_err(|error| UnwritableScene::Document(error.to_string()))?;
        let bytes = json.len() + self.bytes.len();
        glb::join(&json, &self.bytes, &[]).ok_or(UnwritableScene::TooLong { bytes })
    }
}

fn kind<const N: usize>() -> Type {
    match N {
        1 => Type::Scalar,
        2 => Type::Vec2,
        3 => Type::Vec3,
        4 => Type::Vec4,
        _ => Type::Mat4,
    }
}

fn bounds<'a, const N: usize>(values: impl Iterator<Item = &'a [f32; N]>) -> [Value; 2] {
    let (mut low, mut high) = ([f32::INFINITY; N], [f32::NEG_INFINITY; N]);
    for value in values {
        low = std::array::from_fn(|k| low[k].min(value[k]));
        high = std::array::from_fn(|k| high[k].max(value[k]));
    }
    [low, high].map(|bound| bound.iter().copied().collect())
}
