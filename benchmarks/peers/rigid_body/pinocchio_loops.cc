// W1 with Pinocchio's templates, compiled here: the whole robot, its loops closed by constraints, whose Jacobian
// Pinocchio computes.
#include <pinocchio/algorithm/jacobian.hpp>
#include <pinocchio/algorithm/joint-configuration.hpp>
#include <pinocchio/algorithm/kinematics.hpp>
#include <pinocchio/constraints.hpp>

#include "pinocchio_leg.hh"

namespace {

using Constraint = pin::PointAnchorConstraintModel;
using Constraints = std::vector<Constraint, Eigen::aligned_allocator<Constraint>>;
using ConstraintDatas = std::vector<Constraint::ConstraintData, Eigen::aligned_allocator<Constraint::ConstraintData>>;

// Three chains, the platform with its links to S_i, and the spherical joints as constraints.
struct Loops
{
    pin::Model model;
    pin::JointIndex end[LEGS];
    pin::Data data;
    Constraints constraints;
    ConstraintDatas datas;
    Eigen::VectorXd q;
    Eigen::Matrix<double, 9, 18> jacobian;

    Loops()
    {
        for (int i = 0; i < LEGS; ++i) {
            end[i] = add_leg(model, i);
        }
        const pin::JointIndex platform = model.addJoint(0, pin::JointModelFreeFlyer(), pin::SE3::Identity(), "p");
        for (int i = 0; i < LEGS; ++i) {
            Eigen::Matrix3d turned;
            turned << START[i][0], -START[i][1], 0, START[i][1], START[i][0], 0, 0, 0, 1;
            const Eigen::Vector3d corner(CORNER[i][0], CORNER[i][1], 0);
            const pin::JointIndex link =
                model.addJoint(platform, pin::JointModelRZ(), pin::SE3(turned, corner), "l" + std::to_string(i));
            // seen from the link: x along it, z along q_z
            constraints.emplace_back(model, link, at(L_REDUNDANT, 0, 0), end[i], at(L3, 0, 0));
        }
        data = pin::Data(model);
        q = pin::neutral(model);
        jacobian.setZero();
        for (const Constraint &constraint : constraints) {
            datas.push_back(constraint.createData());
        }
    }
};

} // namespace

extern "C" void pinocchio_loops_w1(const double *p, const double *Q, const double *theta, double *J, double *K)
{
    static Loops loops;
    const Eigen::Matrix3d turn = Eigen::Map<const Eigen::Matrix3d>(Q).transpose();
    loops.q.head<9>() = Eigen::Map<const Eigen::Matrix<double, 9, 1>>(theta);
    loops.q.segment<3>(9) = Eigen::Map<const Eigen::Vector3d>(p);
    loops.q.segment<4>(12) = Eigen::Quaterniond(turn).coeffs();
    // The redundant angles are not given: the chains' ends are known once the joint angles are.
    pin::forwardKinematics(loops.model, loops.data, loops.q);
    for (int i = 0; i < LEGS; ++i) {
        const pin::SE3 &last = loops.data.oMi[loops.end[i]];
        const Eigen::Vector3d s = last.translation() + L3 * last.rotation().col(0);
        loops.q[16 + i] = -closed_loop_beta(p, Q, CORNER[i], START[i], s.data());
    }
    pin::computeJointJacobians(loops.model, loops.data, loops.q);
    for (int i = 0; i < LEGS; ++i) {
        loops.constraints[i].calc(loops.model, loops.data, loops.datas[i]);
    }
    pin::getConstraintsJacobian(loops.model, loops.data, loops.constraints, loops.datas, loops.jacobian);
    for (int i = 0; i < LEGS; ++i) {
        const Eigen::Matrix<double, 3, 18> rows = loops.jacobian.middleRows<3>(3 * i);
        for (int row = 0; row < 2; ++row) {
            // x is -a over its length
            const int axis = row == 0 ? 0 : 2;
            const double scale = row == 0 ? L_REDUNDANT : -1.0;
            const Eigen::Vector3d linear = turn * rows.block<1, 3>(axis, 9).transpose();
            const Eigen::Vector3d angular = turn * rows.block<1, 3>(axis, 12).transpose();
            for (int m = 0; m < 3; ++m) {
                J[12 * i + 6 * row + m] = scale * linear[m];
                J[12 * i + 6 * row + 3 + m] = scale * angular[m];
                K[6 * i + 3 * row + m] = -scale * rows(axis, 3 * i + m);
            }
        }
    }
}
