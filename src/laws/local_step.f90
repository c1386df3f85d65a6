!> The local problem of one planar contact, solved exactly: numbers in, numbers out (doc/theory/laws.md).
module sg_local_step
  use sg_kinds, only: wp
  implicit none
  private
  public :: coulomb_step

contains

  !> Impulse of one contact whose other impulses are fixed: 0 <= r_n complementary to u_n >= 0 and Coulomb friction,
  !! for u = W r + q with a symmetric positive definite block W.
  !!
  !! Open, sticking and the two ways of sliding are tried in turn. For friction so large that a sliding case has no
  !! positive normal stiffness (Painleve) only the other one remains.
  pure subroutine coulomb_step(w_nn, w_nt, w_tt, friction, q_n, q_t, r_n, r_t)
    real(wp), intent(in) :: w_nn !! block of W, normal [1/kg]
    real(wp), intent(in) :: w_nt !! block of W, coupling [1/kg]
    real(wp), intent(in) :: w_tt !! block of W, tangential [1/kg]
    real(wp), intent(in) :: friction !! Coulomb coefficient
    real(wp), intent(in) :: q_n !! normal velocity without this impulse [m/s]
    real(wp), intent(in) :: q_t !! tangential velocity without this impulse [m/s]
    real(wp), intent(out) :: r_n !! normal impulse [N s]
    real(wp), intent(out) :: r_t !! tangential impulse [N s]
    real(wp) :: determinant, side, stiffness

    r_n = 0
    r_t = 0
    if (q_n >= 0) return
    determinant = w_nn*w_tt - w_nt**2
    side = -q_t
    if (determinant > 0) then
      r_n = (w_nt*q_t - w_tt*q_n)/determinant
      r_t = (w_nt*q_n - w_nn*q_t)/determinant
      if (r_n >= 0 .and. abs(r_t) <= friction*r_n) return
      if (abs(r_t) > 0) side = r_t
    end if
    side = sign(1.0_wp, side)
    stiffness = w_nn + side*friction*w_nt
    if (stiffness > 0) then
      r_n = -q_n/stiffness
      r_t = side*friction*r_n
      if (side*(q_t + w_nt*r_n + w_tt*r_t) <= 0) return
    end if
    stiffness = w_nn - side*friction*w_nt
    r_n = -q_n/merge(stiffness, w_nn, stiffness > 0)
    r_t = -side*friction*r_n
  end subroutine coulomb_step
end module sg_local_step
