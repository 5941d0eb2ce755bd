// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/answer/answers.h"
#include "algorithms/answer/closest.cl.h"
#include "algorithms/answer/status.h"
#include "algorithms/answer/wrenches.cl.h"

#include <memory>

namespace tandem {

/// Reduces the contacts of a frame on the device to one row for each body pair. Buffers: as many bytes as the
/// contacts have, and some for each body pair.
class ContactReduction {
public:
    /// `bodies` must outlive this.
    ContactReduction(const Bodies& bodies, LaunchShape shape);
    virtual ~ContactReduction() = default;
    ContactReduction(const ContactReduction&) = delete;
    ContactReduction& operator=(const ContactReduction&) = delete;

    /// Where the contacts go that it reduces. Throws OutOfMemory.
    ContactRows source(const AnswerBuffers& answer);
    /// Enqueues it: the rows to `kept`, and their number to the status. `body_pairs`: at least the number of
    /// body pairs that have contacts. Throws OutOfMemory.
    void launch(const AnswerBuffers& answer, const ContactRows& kept, std::uint64_t body_pairs,
                const Status& status);
    /// Whether rows of the same body pair from parts of a frame can be reduced again.
    virtual bool joins_rows() const = 0;

protected:
    /// Contacts and where their rows go.
    struct Task {
        const Buffer &pairs, &ids, &values;
        const ContactRows& kept;
        std::uint32_t places; ///< of the table of body pairs
        const Status& status;
    };
    virtual void do_launch(const Task& task) = 0;

    Defines defines() const;
    Grid grid() const { return {shape_.groups, shape_.group_size}; }

    const Bodies& bodies_;
    GrowableBuffer table_;

private:
    LaunchShape shape_;
    GrowableBuffer contacts_;
    KernelOf<kernels::closest::CountReduced> count_;
};

/// output=distances: keeps the contact with the least distance. Equal distances go to the smaller numbers of
/// the tetrahedra.
class ClosestStage : public ContactReduction {
public:
    ClosestStage(const Bodies& bodies, LaunchShape shape);
    bool joins_rows() const override { return true; }

private:
    void do_launch(const Task& task) override;

    KernelOf<kernels::closest::FindClosest> find_;
    KernelOf<kernels::closest::KeepClosest> keep_;
};

/// output=wrenches: adds up the polygons of contact_rule=pressure: rows of force on body a, torque about its
/// pose and area; the feature is the number of polygons, the pair the one of theirs with the smallest
/// numbers.
class WrenchStage : public ContactReduction {
public:
    WrenchStage(const Bodies& bodies, LaunchShape shape);
    bool joins_rows() const override { return false; }

private:
    void do_launch(const Task& task) override;

    Buffer arms_;
    GrowableBuffer sums_; ///< wrenches.cl
    KernelOf<kernels::wrenches::AddWrenches> add_;
    KernelOf<kernels::wrenches::WriteWrenches> write_;
};

/// The reduction of an output; null for outputs that keep all contacts.
std::unique_ptr<ContactReduction> contact_reduction(Output output, const Bodies& bodies, LaunchShape shape);

} // namespace tandem
