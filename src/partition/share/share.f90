!> The share that one of several ranks keeps of bodies written one by one, and the numbers of what it keeps in the whole scene.
!!
!! Each rank makes every body in turn, at the place behind those that it keeps, so that all ranks find the same mistakes; a body
!! of another rank's is noted and its place taken by the next one. Some bodies every rank keeps: those that are driven, pressed
!! or held. Of the others rank r has an even piece, in the order of their numbers (doc/theory/decomposition.md). Bodies may be made
!! in two lots, as those of a DATBOX and those of the deck: of each lot a rank has a piece.
module sg_share
  use sg_ascending, only: first_at_least, place_in
  use sg_census, only: census_t
  use sg_contactors, only: contactors_t, drop_contactors, kind_point, make_rows, table_all
  use sg_kinds, only: wp, i4, i8
  use sg_link_network, only: place_of_point, points_t
  use sg_lists, only: reserve
  use sg_scene, only: scene_t
  implicit none
  private
  public :: share_t, piece_of

  !> Place of no body [m]
  real(wp), parameter :: nowhere = huge(1.0_wp)

  !> Bodies made one by one
  type :: share_t
    !> Which of how many ranks keeps a share
    integer :: rank = 0, ranks = 1
    !> Numbers of the bodies that every rank keeps, ascending, each once
    integer(i4), allocatable :: common(:)
    !> Numbers up to which bodies are to be made; bodies made so far, and their contactors
    integer :: all = 0, made = 0, contactors = 0
    !> What is known of bodies that other ranks keep
    type(census_t) :: census
    !> Points of all bodies, whoever keeps them
    type(points_t) :: points
    !> Are states that a DATBOX gives to bodies of other ranks to be noted? Defaults of a deck's interactions follow from them
    logical :: notes_states = .false.
    !> Of such bodies, by number: place now [m], way from that of BODIES.DAT [m], speed [m/s], shape (7, bodies); of others a place
    !! hugely far off
    real(wp), allocatable, private :: state(:, :)
    !> Bodies of earlier lots
    integer, private :: earlier = 0
    !> First and last that this rank keeps of the bodies of the lot that are not common, counted without those
    integer, private :: piece(2) = 0
    !> Contactors of the scene before those of the body being made
    integer, private :: before = 0
    !> Runs of bodies with as many contactors each: number of the first body, of its first contactor, contactors a body
    integer, private :: n_runs = 0
    integer(i4), allocatable, private :: run(:, :)
  contains
    procedure :: begin => share_begin
    procedure :: kept => share_kept
    procedure :: settle => share_settle
    procedure :: finish => share_finish
    procedure :: contactors_of => share_contactors_of
    procedure :: note_state => share_note_state
    procedure :: states_are_read => share_states_are_read
  end type share_t

contains

  !> Make room for the bodies of a lot that this rank keeps, behind those of earlier lots.
  subroutine share_begin(self, scene, n, more)
    class(share_t), intent(inout) :: self !! with the ranks, and the bodies that all keep set
    type(scene_t), intent(inout) :: scene !! scene with its dimension and the bodies of earlier lots
    integer, intent(in) :: n !! bodies to be made one by one, of all ranks
    integer, intent(in) :: more !! other bodies for which there is to be room
    integer :: room

    self%earlier = self%made
    self%all = self%earlier + n
    if (.not. allocated(self%common)) allocate (self%common(0))
    self%common = pack(self%common, self%common > self%earlier .and. self%common <= self%all)
    self%piece = piece_of(n - size(self%common), self%rank, self%ranks)
    self%before = scene%contactors%n
    room = self%kept() + more
    ! A place for bodies that are only noted.
    if (self%kept() < n .and. more == 0) room = room + 1
    if (self%earlier > 0) then
      call make_more_room(scene, room)
      return
    end if
    call scene%bodies%allocate(room, scene%dimension)
    if (self%ranks == 1) return
    allocate (scene%bodies%id(room), scene%bodies%owner(room), source=-1_i4)
    allocate (scene%contactors%id(0))
  end subroutine share_begin

  !> Make room behind the bodies that a scene has.
  subroutine make_more_room(scene, more)
    type(scene_t), intent(inout) :: scene
    integer, intent(in) :: more

    associate (bodies => scene%bodies)
      bodies%n = bodies%n + more
      bodies%n_own = bodies%n
      call bodies%resize(bodies%n)
    end associate
  end subroutine make_more_room

  !> Bodies of the lot that this rank keeps.
  pure integer function share_kept(self) result(n)
    class(share_t), intent(in) :: self

    n = self%all - self%earlier
    if (self%ranks > 1) n = size(self%common) + self%piece(2) - self%piece(1) + 1
  end function share_kept

  !> The body behind the last one kept is made: keep it, or note it and leave its place to the next one.
  subroutine share_settle(self, scene, n)
    class(share_t), intent(inout) :: self
    type(scene_t), intent(inout) :: scene !! scene with the body
    integer, intent(inout) :: n !! bodies kept so far
    integer :: c, below
    logical :: is_common

    self%made = self%made + 1
    call note_run(self, scene%contactors%n - self%before)
    call note_points(self, scene, n + 1)
    if (self%ranks == 1) then
      n = n + 1
    else
      call self%census%mix(transfer(scene%bodies%mass(n + 1), 1_i8))
      is_common = place_in(self%common, int(self%made, i4)) > 0
      below = self%earlier + first_at_least(self%common, int(self%made, i4)) - 1
      if (is_common .or. (self%made - below >= self%piece(1) .and. self%made - below <= self%piece(2))) then
        n = n + 1
        scene%bodies%id(n) = int(self%made, i4)
        scene%bodies%owner(n) = int(merge(-1, self%rank, is_common), i4)
        ! The list of an earlier lot has no room left.
        call reserve(scene%contactors%id, scene%contactors%n)
        do c = self%before + 1, scene%contactors%n
          scene%contactors%id(c) = int(self%contactors + c - self%before, i4)
        end do
      end if
    end if
    self%contactors = self%contactors + scene%contactors%n - self%before
    if (self%ranks > 1) call let_go(self, scene, n)
    self%before = scene%contactors%n
  end subroutine share_settle

  !> Note the points of the body being settled: links join them whoever keeps their bodies.
  subroutine note_points(self, scene, body)
    class(share_t), intent(inout) :: self
    type(scene_t), intent(in) :: scene
    integer, intent(in) :: body
    integer :: c

    do c = self%before + 1, scene%contactors%n
      if (scene%contactors%kind(c) /= kind_point) cycle
      call self%points%note(self%contactors + c - self%before, self%made, int(scene%contactors%colour(c)), &
                            place_of_point(scene, body, scene%contactors%shift(:, c)))
    end do
  end subroutine note_points

  !> Note the body behind the last one kept, if there is one, and clear its place.
  subroutine let_go(self, scene, n)
    class(share_t), intent(inout) :: self
    type(scene_t), intent(inout) :: scene
    integer, intent(in) :: n

    if (self%notes_states) call reserve(self%state, 7, self%made)
    if (self%notes_states) self%state(1, self%made) = nowhere
    if (n > 0) then
      if (scene%bodies%id(n) == self%made) return
    end if
    if (self%notes_states) self%state(:scene%dimension, self%made) = scene%bodies%position(:, n + 1)
    if (scene%contactors%n > self%before) &
      call self%census%note_body(self%made, scene%bodies%position(:, n + 1), &
                                 norm2(scene%bodies%velocity(:scene%dimension, n + 1)), scene%contactors, self%before + 1)
    call drop_contactors(scene%contactors, self%before)
    call scene%bodies%clear(n + 1)
  end subroutine let_go

  !> Note the state of a body that another rank keeps. Of two states the last counts.
  pure subroutine share_note_state(self, number, displacement, speed)
    class(share_t), intent(inout) :: self
    integer, intent(in) :: number !! of the body
    real(wp), intent(in) :: displacement(:) !! from its place in BODIES.DAT [m], shape (dimension)
    real(wp), intent(in) :: speed !! [m/s]
    integer :: d

    if (.not. self%notes_states) return
    d = size(displacement)
    associate (state => self%state(:, number))
      ! The sum that gives the place where the body is kept, so that all ranks have the same.
      state(:d) = state(:d) + (displacement - state(4:3 + d))
      state(4:3 + d) = displacement
      state(7) = speed
    end associate
  end subroutine share_note_state

  !> All states are read: describe the bodies that other ranks keep by them.
  subroutine share_states_are_read(self)
    class(share_t), intent(inout) :: self
    integer :: i

    if (.not. allocated(self%state)) return
    associate (census => self%census)
      census%low = huge(1.0_wp)
      census%high = -huge(1.0_wp)
      do i = 1, self%made
        if (.not. self%state(1, i) < nowhere) cycle
        census%low = min(census%low, self%state(:3, i))
        census%high = max(census%high, self%state(:3, i))
        census%speed = max(census%speed, self%state(7, i))
      end do
    end associate
    deallocate (self%state)
    self%notes_states = .false.
  end subroutine share_states_are_read

  !> All bodies are made: give back the room that is left.
  subroutine share_finish(self, scene, n)
    class(share_t), intent(in) :: self
    type(scene_t), intent(inout) :: scene !! scene with its bodies
    integer, intent(in) :: n !! bodies kept
    type(contactors_t) :: nothing

    if (n < scene%bodies%n) then
      scene%bodies%n = n
      scene%bodies%n_own = n
      call scene%bodies%resize(n)
    end if
    if (self%ranks == 1) return
    scene%contactors%id = scene%contactors%id(:scene%contactors%n)
    if (scene%contactors%n > 0) return
    nothing%dimension = scene%dimension
    scene%contactors = nothing
    allocate (scene%contactors%id(0))
    call make_rows(scene%contactors, table_all, 0)
  end subroutine share_finish

  !> Note how many contactors the next body has.
  subroutine note_run(self, count)
    class(share_t), intent(inout) :: self
    integer, intent(in) :: count

    if (self%n_runs > 0) then
      if (self%run(3, self%n_runs) == count) return
    end if
    self%n_runs = self%n_runs + 1
    call reserve(self%run, 3, self%n_runs)
    self%run(:, self%n_runs) = int([self%made, self%contactors + 1, count], i4)
  end subroutine note_run

  !> Numbers of the first and the last contactor of a body, whoever keeps it.
  pure function share_contactors_of(self, body) result(ends)
    class(share_t), intent(in) :: self
    integer, intent(in) :: body !! number of a body made
    integer :: ends(2), run

    run = first_at_least(self%run(1, :self%n_runs), int(body + 1, i4)) - 1
    associate (first => self%run(1, run), contactor => self%run(2, run), count => self%run(3, run))
      ends = contactor + (body - first)*count + [0, count - 1]
    end associate
  end function share_contactors_of

  !> The piece of some things that one of several ranks has: first and last.
  pure function piece_of(n, rank, ranks) result(piece)
    integer, intent(in) :: n !! things
    integer, intent(in) :: rank !! from 0
    integer, intent(in) :: ranks !! how many
    integer :: piece(2)

    piece = int(int(n, i8)*int([rank, rank + 1], i8)/int(ranks, i8))
    piece(1) = piece(1) + 1
  end function piece_of
end module sg_share
