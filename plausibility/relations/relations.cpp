#include "plausibility/relations/relations.h"

namespace flextip::plausibility {

std::vector<Relation> RelationsOf(const Scene& scene) {
  RelationList list(scene);
  AddWristRelations(list);
  AddEndRelations(list);
  AddForceRelations(list);
  AddCameraRelations(list);
  return list.Take();
}

}  // namespace flextip::plausibility
