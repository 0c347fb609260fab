// A leg of the closed-loop model as joints of Pinocchio.
#ifndef PINOCCHIO_LEG_HH
#define PINOCCHIO_LEG_HH

#include <pinocchio/multibody.hpp>

#include "closed_loop.h"
#include "geometry.h"

namespace pin = pinocchio;

inline pin::SE3 at(double x, double y, double z)
{
    return pin::SE3(Eigen::Matrix3d::Identity(), Eigen::Vector3d(x, y, z));
}

inline pin::JointIndex add_leg(pin::Model &model, int i)
{
    const Eigen::Matrix3d base = Eigen::Map<const Eigen::Matrix3d>(BASE[i]);
    Eigen::Matrix3d upright;
    upright << 1, 0, 0, 0, 0, -1, 0, 1, 0; // the second axis is -y of the first joint
    const Eigen::Vector3d shoulder(SHOULDER[i][0], SHOULDER[i][1], SHOULDER[i][2]);
    const std::string name = std::to_string(i);
    pin::JointIndex joint = model.addJoint(0, pin::JointModelRZ(), pin::SE3(base, shoulder), name + "a");
    joint = model.addJoint(joint, pin::JointModelRZ(), pin::SE3(upright, Eigen::Vector3d::Zero()), name + "b");
    return model.addJoint(joint, pin::JointModelRZ(), at(L2, 0, 0), name + "c");
}

#endif
