#pragma once
/// Ownership of PETSc objects.

#include <petscksp.h>
#include <slepcbv.h>
#include <slepceps.h>

#include <exception>
#include <utility>

namespace stickslip::petsc {

/// Move-only owner of one PETSc object; converts to the raw handle, which every PETSc call takes.
///
/// Destruction is collective. When one rank unwinds alone, a collective Destroy would make it wait
/// for the others for ever; so a handle that dies during unwinding on several ranks forgets its
/// object, and main ends all ranks with MPI_Abort.
template <class T, PetscErrorCode (*Destroy)(T*)>
class Handle {
 public:
  Handle() = default;
  explicit Handle(T object) : object_(object) {}
  Handle(Handle&& other) noexcept : object_(std::exchange(other.object_, nullptr)) {}
  Handle& operator=(Handle&& other) noexcept {
    if (this != &other) {
      reset();
      object_ = std::exchange(other.object_, nullptr);
    }
    return *this;
  }
  Handle(const Handle&) = delete;
  Handle& operator=(const Handle&) = delete;
  ~Handle() { reset(); }

  /// Address to create an object into; what was held before is destroyed.
  [[nodiscard]] T* out() {
    reset();
    return &object_;
  }
  // NOLINTNEXTLINE(google-explicit-constructor): a handle stands for its object in PETSc calls.
  operator T() const { return object_; }

 private:
  void reset() noexcept {
    if (object_ == nullptr) return;
    if (std::uncaught_exceptions() > 0 && ranks() > 1) return;
    (void)Destroy(&object_);
    object_ = nullptr;
  }
  [[nodiscard]] int ranks() const {
    int size = 1;
    MPI_Comm_size(PetscObjectComm(reinterpret_cast<PetscObject>(object_)), &size);
    return size;
  }

  T object_ = nullptr;
};

using VecHandle = Handle<Vec, VecDestroy>;
using MatHandle = Handle<Mat, MatDestroy>;
using KspHandle = Handle<KSP, KSPDestroy>;
using BvHandle = Handle<BV, BVDestroy>;
using EpsHandle = Handle<EPS, EPSDestroy>;

}  // namespace stickslip::petsc
