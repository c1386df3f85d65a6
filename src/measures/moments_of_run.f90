!> Where, when and between which bodies the worst value of a run was found, with a hint at its cause.
module sg_moments_of_run
  use sg_contacts, only: contacts_t
  use sg_kinds, only: wp, i4
  use sg_scene, only: scene_t
  use sg_text, only: to_text
  implicit none
  private
  public :: moment_t, moment_of, hint_words, place_words, n_moment_values

  !> Numbers that `pack` writes
  integer, parameter :: n_moment_values = 8
  !> Causes: none found, the step did not converge, a driven or pressed body pushes, the bodies meet fast
  integer, parameter :: hint_none = 0, hint_unconverged = 1, hint_driven = 2, hint_shock = 3

  !> A contact at one step
  type :: moment_t
    !> Step, 0 for none, and its end [s]
    integer :: step = 0
    real(wp) :: time = 0
    !> Numbers of the two bodies in the whole scene, 0 where not found; and the point of contact [m]
    integer :: bodies(2) = 0
    real(wp) :: place(3) = 0
    !> Cause, one of `hint_*`
    integer :: hint = hint_none
  contains
    procedure :: pack => moment_pack
    procedure :: unpack => moment_unpack
  end type moment_t

contains

  !> A contact of a step that is solved but not updated: `velocity` is that of its beginning.
  pure function moment_of(scene, contacts, k, step, time, fast, is_converged) result(moment)
    type(scene_t), intent(in) :: scene !! scene of the step
    type(contacts_t), intent(in) :: contacts !! contacts of the step
    integer, intent(in) :: k !! the contact
    integer, intent(in) :: step !! number of the step
    real(wp), intent(in) :: time !! its end [s]
    real(wp), intent(in) :: fast !! velocity of approach from which on the bodies meet fast [m/s]
    logical, intent(in) :: is_converged !! did the solve converge?
    type(moment_t) :: moment
    real(wp) :: jump(3)
    integer :: side, d

    d = scene%dimension
    moment%step = step
    moment%time = time
    moment%place(:d) = contacts%point(1:d, k)
    associate (bodies => scene%bodies, body => contacts%body(:, k))
      do side = 1, 2
        moment%bodies(side) = int(body(side))
        if (allocated(bodies%id)) moment%bodies(side) = int(bodies%id(body(side)))
      end do
      jump = 0
      jump(:d) = bodies%velocity(1:d, body(1)) - bodies%velocity(1:d, body(2))
      if (any([(moves(body(side)), side=1, 2)])) then
        moment%hint = hint_driven
      else if (.not. is_converged) then
        moment%hint = hint_unconverged
      else if (-dot_product(jump(:d), contacts%normal(1:d, k)) > fast) then
        moment%hint = hint_shock
      end if
    end associate
  contains
    !> Is a body driven or pressed, and on its way?
    pure logical function moves(body)
      integer(i4), intent(in) :: body

      moves = .not. scene%bodies%is_grain(body) .and. any(abs(scene%bodies%velocity(:, body)) > 0)
    end function moves
  end function moment_of

  !> The cause in words, after what was found; empty where none was.
  pure function hint_words(moment) result(words)
    type(moment_t), intent(in) :: moment !! the moment
    character(len=:), allocatable :: words

    select case (moment%hint)
    case (hint_unconverged)
      words = 'the step did not converge'
    case (hint_driven)
      words = 'pushed by a driven body'
    case (hint_shock)
      words = 'a shock, try shorter steps'
    case default
      words = ''
    end select
  end function hint_words

  !> The place in words.
  pure function place_words(moment, dimension) result(words)
    type(moment_t), intent(in) :: moment !! the moment
    integer, intent(in) :: dimension !! of space
    character(len=:), allocatable :: words
    integer :: a

    words = '('//to_text(moment%place(1), 3)
    do a = 2, dimension
      words = words//', '//to_text(moment%place(a), 3)
    end do
    words = words//') m'
  end function place_words

  !> The moment as a list of reals, for restart files.
  pure function moment_pack(self) result(values)
    class(moment_t), intent(in) :: self
    real(wp) :: values(n_moment_values)

    values = [real(self%step, wp), self%time, real(self%bodies, wp), self%place, real(self%hint, wp)]
  end function moment_pack

  !> The moment back from a list of reals.
  pure subroutine moment_unpack(self, values)
    class(moment_t), intent(inout) :: self
    real(wp), intent(in) :: values(n_moment_values) !! what `pack` gave

    self%step = nint(values(1))
    self%time = values(2)
    self%bodies = nint(values(3:4))
    self%place = values(5:7)
    self%hint = nint(values(8))
  end subroutine moment_unpack
end module sg_moments_of_run
