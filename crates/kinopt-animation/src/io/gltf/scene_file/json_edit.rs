//! Editing of JSON in single places; the rest keeps its original text.

use std::fmt;

use serde::de::{Deserialize, Deserializer, MapAccess, Visitor};
use serde::ser::{Serialize, Serializer};
use serde_json::value::{RawValue, to_raw_value};

/// Members of an object in their order, each value as its original text.
#[derive(Clone, Debug, Default)]
pub(super) struct Members(Vec<(String, Box<RawValue>)>);

impl Members {
    pub(super) fn get(&self, key: &str) -> Option<&RawValue> {
        let member = self.0.iter().find(|(name, _)| name == key);
        member.map(|(_, value)| value.as_ref())
    }

    /// Replaces the value of a member, or appends the member.
    pub(super) fn set(&mut self, key: &str, value: &impl Serialize) -> serde_json::Result<()> {
        let value = to_raw_value(value)?;
        match self.0.iter_mut().find(|(name, _)| name == key) {
            Some((_, existing)) => *existing = value,
            None => self.0.push((key.to_owned(), value)),
        }
        Ok(())
    }

    pub(super) fn remove(&mut self, key: &str) {
        self.0.retain(|(name, _)| name != key);
    }

    /// The elements of a list as their original text; empty without the list.
    pub(super) fn list(&self, key: &str) -> serde_json::Result<Vec<Box<RawValue>>> {
        self.get(key)
            .map_or(Ok(Vec::new()), |list| serde_json::from_str(list.get()))
    }

    /// Appends elements to a list and returns its previous length.
    pub(super) fn append<T: Serialize>(
        &mut self,
        key: &str,
        elements: &[T],
    ) -> serde_json::Result<usize> {
        let mut list = self.list(key)?;
        let before = list.len();
        if !elements.is_empty() {
            for element in elements {
                list.push(to_raw_value(element)?);
            }
            self.set(key, &list)?;
        }
        Ok(before)
    }

    /// Changes elements of a list of objects; `change` returns whether it changed the element.
    pub(super) fn change_each(
        &mut self,
        key: &str,
        mut change: impl FnMut(usize, &mut Self) -> serde_json::Result<bool>,
    ) -> serde_json::Result<()> {
        let mut list = self.list(key)?;
        let mut changed = false;
        for (index, element) in list.iter_mut().enumerate() {
            let mut members: Self = serde_json::from_str(element.get())?;
            if change(index, &mut members)? {
                *element = to_raw_value(&members)?;
                changed = true;
            }
        }
        match changed {
            true => self.set(key, &list),
            false => Ok(()),
        }
    }
}

impl Serialize for Members {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_map(self.0.iter().map(|(key, value)| (key, value)))
    }
}

impl<'de> Deserialize<'de> for Members {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_map(InOrder)
    }
}

struct InOrder;

impl<'de> Visitor<'de> for InOrder {
    type Value = Members;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a JSON object")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Members, A::Error> {
        let mut members = Vec::new();
        while let Some(member) = map.next_entry()? {
            members.push(member);
        }
        Ok(Members(members))
    }
}
