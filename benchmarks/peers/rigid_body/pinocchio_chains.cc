// W1 and W2 with Pinocchio's templates, compiled here: it computes the chains' end points and their Jacobians, and
// closed_loop.h makes J, K and the joint angles of them.
#include <pinocchio/algorithm/frames.hpp>
#include <pinocchio/algorithm/jacobian.hpp>

#include "pinocchio_leg.hh"

namespace {

// Three chains, and the frames S_i at their ends.
struct Chains
{
    pin::Model model;
    pin::FrameIndex end[LEGS];
    pin::Data data;
    Eigen::VectorXd q{9};
    Eigen::Matrix<double, 6, 9> columns;
    Eigen::Vector3d s[LEGS];

    Chains()
    {
        for (int i = 0; i < LEGS; ++i) {
            const pin::JointIndex joint = add_leg(model, i);
            end[i] = model.addFrame(pin::Frame("S" + std::to_string(i), joint, at(L3, 0, 0), pin::OP_FRAME));
        }
        data = pin::Data(model);
        columns.setZero();
    }

    // S_i and the columns of M_i, at q. What one leg's Jacobian leaves as it was is zero or another leg's column.
    void update()
    {
        pin::computeJointJacobians(model, data, q);
        for (int i = 0; i < LEGS; ++i) {
            pin::updateFramePlacement(model, data, end[i]);
            pin::getFrameJacobian(model, data, end[i], pin::LOCAL_WORLD_ALIGNED, columns);
            s[i] = data.oMf[end[i]].translation();
        }
    }
};

} // namespace

extern "C" void pinocchio_chains_w1(const double *p, const double *Q, const double *theta, double *J, double *K)
{
    static Chains chains;
    chains.q = Eigen::Map<const Eigen::VectorXd>(theta, 9);
    chains.update();
    for (int i = 0; i < LEGS; ++i) {
        const double *const column[3] = {&chains.columns(0, 3 * i), &chains.columns(0, 3 * i + 1),
                                         &chains.columns(0, 3 * i + 2)};
        closed_loop_rows(p, Q, CORNER[i], chains.s[i].data(), column, J + 12 * i, K + 6 * i);
    }
}

extern "C" void pinocchio_w2(const double *p, const double *Q, const double *beta, double *theta)
{
    static Chains chains;
    double wanted[LEGS][3], change = 1.0;
    for (int i = 0; i < LEGS; ++i) {
        closed_loop_end_point(p, Q, CORNER[i], START[i], L_REDUNDANT, beta[i], wanted[i]);
    }
    chains.q = Eigen::Map<const Eigen::VectorXd>(HOME, 9);
    for (int step = 0; step < MOST_STEPS && change > ACCURATE; ++step) {
        chains.update();
        change = 0.0;
        for (int i = 0; i < LEGS; ++i) {
            const double *const column[3] = {&chains.columns(0, 3 * i), &chains.columns(0, 3 * i + 1),
                                             &chains.columns(0, 3 * i + 2)};
            change = std::fmax(change, closed_loop_step(wanted[i], chains.s[i].data(), column, &chains.q[3 * i]));
        }
    }
    Eigen::Map<Eigen::VectorXd>(theta, 9) = chains.q;
}
