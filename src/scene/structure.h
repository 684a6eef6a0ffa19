// SPDX-License-Identifier: MIT
// From geometries to trees, and from trees to one tree.
//
// The geometries of a scene are in groups, each with a tree of its own: all that do not change share one,
// each large one that does has its own (groups.c). A commit takes over from the last one the trees of the
// groups that are as they were, renews or builds the others, and puts them all together (assemble.c).
#ifndef SAGI_SCENE_STRUCTURE_H
#define SAGI_SCENE_STRUCTURE_H

#include "scene/scene.h"

// A group's primitives on their way to a tree (structure.c). Zero but for the first two.
typedef struct sagi_structure {
    sagi_snapshot *snapshot;
    sagi_group *group;
    uint64_t *first; // of each member's primitives in the group's numbering; one more than there are members
    uint64_t count;
    struct sagi_chunk *chunks;
    size_t chunk_count;
    sagi_bvh_primitive *primitives; // in the second round
} sagi_structure;

// Finds out what the members' primitives are: fills in the group's counts and bounds. SAG_ERROR_MEMORY.
sag_status sagi_structure_survey(sagi_structure *w);
// Then, when the snapshot's units and the place of the group's unbounded primitives are known, the tree.
sag_status sagi_structure_build(sagi_structure *w, sagi_bvh *tree);
void sagi_structure_release(sagi_structure *w);

// What is to become of a group at a commit.
typedef enum sagi_plan {
    SAGI_BUILD, // a new tree
    SAGI_KEEP,  // the one it had
    SAGI_REFIT, // the one it had, with new boxes
} sagi_plan;

typedef struct sagi_job {
    sagi_plan plan;
    const sagi_group *before; // KEEP, REFIT
    sagi_structure work;
    sagi_bvh tree; // BUILD: its tree, until it is part of the scene's
} sagi_job;

// Forms the groups of a snapshot whose entries are filled in; all in one when `single`. SAG_ERROR_MEMORY.
sag_status sagi_groups_form(sagi_snapshot *s, bool single);
void sagi_groups_release(sagi_snapshot *s);

// Puts the groups' trees together as the snapshot's; those of the jobs are used up. SAG_ERROR_MEMORY,
// SAG_ERROR_ARGUMENT for too many nodes; *too_deep, and nothing made, when a path would be too long.
sag_status sagi_assemble(sagi_snapshot *s, const sagi_snapshot *old, sagi_job *jobs, bool *too_deep);

// Renews the boxes and leaves of a group whose tree is part of the snapshot's. False, having renewed some of
// them, when what is in the tree is not good any more.
bool sagi_refit(sagi_snapshot *s, sagi_group *group);

#endif
