//! Physical groups, and the sets of them that elements belong to.

use std::collections::{BTreeSet, HashMap};

use kluft_mesh::Group;

use super::entities::{EntityGroups, EntityKey, entity_name};

/// Groups by index, and the set of groups of each entity.
pub(super) struct Groups {
    pub(super) groups: Vec<Group>,
    /// Distinct sets of indices into `groups`, ascending; those the elements use.
    pub(super) sets: Vec<Vec<usize>>,
    index: HashMap<EntityKey, usize>,
    set_index: HashMap<Vec<usize>, u32>,
}

impl Groups {
    /// The named groups in file order, then the others by dimension and tag.
    pub(super) fn new(named: Vec<Group>, entities: &EntityGroups) -> Self {
        let mut groups = Self {
            groups: Vec::new(),
            sets: Vec::new(),
            index: HashMap::new(),
            set_index: HashMap::new(),
        };
        named.into_iter().for_each(|group| groups.add(group));
        for (dimension, tag) in all_groups(entities) {
            if !groups.index.contains_key(&(dimension, tag)) {
                let name = tag.to_string();
                groups.add(Group {
                    dimension,
                    tag,
                    name,
                });
            }
        }
        groups
    }

    fn add(&mut self, group: Group) {
        self.index
            .insert((group.dimension, group.tag), self.groups.len());
        self.groups.push(group);
    }

    /// Index into `sets` for the elements of an entity.
    pub(super) fn set_of(&mut self, entity: EntityKey, entities: &EntityGroups) -> u32 {
        let set = self.indices(entity, entities);
        let next = self.sets.len() as u32;
        *self.set_index.entry(set).or_insert_with_key(|set| {
            self.sets.push(set.clone());
            next
        })
    }

    /// The groups of an entity, for messages: their names, or the entity itself.
    pub(super) fn describe(&self, entity: EntityKey, entities: &EntityGroups) -> String {
        let names: Vec<String> = self
            .indices(entity, entities)
            .iter()
            .map(|&index| format!("\"{}\"", self.groups[index].name))
            .collect();
        match names.as_slice() {
            [] => entity_name(entity),
            names => names.join(", "),
        }
    }

    fn indices(&self, entity: EntityKey, entities: &EntityGroups) -> Vec<usize> {
        let tags = entities.get(&entity).map_or(&[][..], Vec::as_slice);
        let keys = tags.iter().map(|&tag| (entity.0, tag));
        let set: BTreeSet<usize> = keys
            .filter_map(|key| self.index.get(&key).copied())
            .collect();
        set.into_iter().collect()
    }
}

fn all_groups(entities: &EntityGroups) -> BTreeSet<EntityKey> {
    let groups_of = |(key, tags): (&EntityKey, &Vec<i32>)| {
        let dimension = key.0;
        tags.iter()
            .map(move |&tag| (dimension, tag))
            .collect::<Vec<_>>()
    };
    entities.iter().flat_map(groups_of).collect()
}
