// SPDX-License-Identifier: Apache-2.0
#include "sim/physics/contacts.hpp"

#include <utility>

namespace handsel::sim {

void gather(btDispatcher& dispatcher, double dt, double reach, std::vector<Touch>& out) {
  out.clear();
  for (int i = 0; i < dispatcher.getNumManifolds(); ++i) {
    const btPersistentManifold& manifold = *dispatcher.getManifoldByIndexInternal(i);
    for (int k = 0; k < manifold.getNumContacts(); ++k) {
      const btManifoldPoint& point = manifold.getContactPoint(k);
      if (point.getDistance() > reach) continue;
      Touch t;
      t.a = static_cast<Owner>(manifold.getBody0()->getUserIndex());
      t.index_a = manifold.getBody0()->getUserIndex2();
      t.b = static_cast<Owner>(manifold.getBody1()->getUserIndex());
      t.index_b = manifold.getBody1()->getUserIndex2();
      t.point = from_bt(point.getPositionWorldOnB());
      t.normal = from_bt(point.m_normalWorldOnB);
      t.distance = point.getDistance();
      t.friction = point.m_combinedFriction;
      t.torsion = point.m_combinedSpinningFriction;
      t.normal_force = point.m_appliedImpulse / dt;
      t.force_on_a = t.normal_force * t.normal +
                     point.m_appliedImpulseLateral1 / dt * from_bt(point.m_lateralFrictionDir1) +
                     point.m_appliedImpulseLateral2 / dt * from_bt(point.m_lateralFrictionDir2);
      if (t.b == Owner::robot || (t.b == Owner::object && t.a != Owner::robot)) {
        std::swap(t.a, t.b);
        std::swap(t.index_a, t.index_b);
        t.normal = -t.normal;
        t.force_on_a = -t.force_on_a;
      }
      out.push_back(t);
    }
  }
}

}  // namespace handsel::sim
