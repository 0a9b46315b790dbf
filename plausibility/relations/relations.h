// All that the streams of a scene say of one another.
#pragma once

#include <vector>

#include "plausibility/relations/relation.h"

namespace flextip::plausibility {

/// Returns every relation that the scene's streams allow. A stream that is never there at the same
/// time as the wrist has one of misfit 3.
std::vector<Relation> RelationsOf(const Scene& scene);

// The groups, a file each.
/// Adds common times, the wrist's reach, its axis toward the port, its command.
void AddWristRelations(RelationList& list);
/// Adds the places and directions of em0, em1 and the tip: on the shaft, through the port, and
/// beside one another.
void AddEndRelations(RelationList& list);
/// Adds moments, load and the bending that they make.
void AddForceRelations(RelationList& list);
/// Adds the camera's view of the tip, and its line of sight.
void AddCameraRelations(RelationList& list);

}  // namespace flextip::plausibility
