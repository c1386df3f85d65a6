!> Contacts that are kept while their pair hardly moves: against a detection of the moved pair, on random pairs in the plane and in
!! space; what is kept is left alone until the pair has moved too far; packs on any number of subdomains.
program test_kept_contacts
  use fresh_simulations, only: fresh
  use harness, only: tests_t
  use packs, only: advance_pack, can_be_made, pack_deck, start_pack
  use scenes, only: begin_run, begin_scene, put_polygon, put_wall
  use scenes_space, only: begin_space_scene, put_box, put_plane
  use sg_comm, only: comm_t
  use sg_detect, only: detect
  use sg_error, only: error_t
  use sg_history, only: exchange_kept, keep_contacts
  use sg_kinds, only: wp, i1, pi
  use sg_polygon_pairs, only: are_mostly_kept, are_plain_polygons
  use sg_random, only: random_t
  use sg_rotations, only: quaternion_product, rotation_by, turned_by
  use sg_simulation, only: decompose, simulation_t
  use subdomain_tests, only: on_subdomains
  implicit none
  ! A hundred times the default, so that other corners and faces do come first at times.
  real(wp), parameter :: motion = 0.1_wp, alert = 0.2_wp
  ! Coordinates of order ten, some tens of operations.
  real(wp), parameter :: rounding = 1e-12_wp
  type(tests_t) :: t

  call test_pairs(2, .false.)
  call test_pairs(2, .true.)
  call test_pairs(3, .false.)
  call test_pairs(3, .true.)
  call on_subdomains(test_packs)
  call t%finish()

contains

  !> Random pairs, of two grains or a grain and a wall, that move by up to the length or by more.
  !!
  !! By less, the least gap is that of a new detection up to twice the motion (doc/theory/detection.md). Many are exact: of two
  !! shapes that slide or turn a little the same corner stays over the same face; of walls all are.
  subroutine test_pairs(dimension, has_wall)
    integer, intent(in) :: dimension
    logical, intent(in) :: has_wall
    type(random_t) :: random
    type(simulation_t), pointer :: start, kept, found, general
    character(len=:), allocatable :: name
    real(wp) :: length, share, error, worst
    integer :: i, n_exact, n_kept, n_other, n_followed

    kept => fresh()
    found => fresh()
    general => fresh()
    name = trim(merge('plane', 'space', dimension == 2)//merge(', wall', '      ', has_wall))
    call random%seed(7)
    worst = 0
    n_exact = 0
    n_kept = 0
    n_other = 0
    n_followed = 0
    do i = 1, 1500
      call make_pair(random, dimension, has_wall, start)
      call detect(start%scene, start%pairs, start%history, start%contacts)
      if (start%contacts%n == 0) cycle
      call copy(start, kept)
      share = random%uniform(0.0_wp, 1.0_wp)
      if (modulo(i, 3) == 0) share = share + 1.0001_wp
      length = motion*minval(start%scene%contactors%reach(:2))
      call move_pair(random, share*length, kept)
      call copy(kept, found)
      found%contacts%kept = 0
      if (dimension == 2) call copy(kept, general)
      if (modulo(i, 2) == 0) n_followed = n_followed + followed_now(kept)
      call detect(kept%scene, kept%pairs, kept%history, kept%contacts)
      if (dimension == 2) call check_general_way(name, kept, general)
      call detect(found%scene, found%pairs, found%history, found%contacts)
      if (share > 1) then
        call t%check(is_same(kept, found), name//': detected again where it has moved too far')
        n_other = n_other + 1
        cycle
      end if
      call t%equal(kept%contacts%n, start%contacts%n, name//': contacts stay')
      if (kept%contacts%n /= start%contacts%n .or. found%contacts%n == 0) cycle
      call check_followed(name, start, kept)
      associate (n => kept%contacts%n)
        call t%check(all(kept%contacts%is_kept(:n) > 0_i1) .and. &
                     .not. any(abs(kept%contacts%kept(:, :n) - start%contacts%kept(:, :n)) > 0), name//': what is kept stays')
        error = abs(minval(kept%contacts%gap(:n)) - minval(found%contacts%gap(:found%contacts%n)))
      end associate
      n_kept = n_kept + 1
      if (error < rounding) n_exact = n_exact + 1
      worst = max(worst, error/(share*length))
    end do
    print '(a, 3i6, f7.3)', name//': kept, exact, moved too far, worst error over the motion', n_kept, n_exact, n_other, worst
    call t%check(min(n_kept, n_other) > 100, name//': many pairs')
    call t%check(worst <= 2*(1 + alert), name//': gaps are off by twice the motion at most')
    call t%check(3*n_exact > n_kept, name//': many are exact')
    call t%check((n_followed > 100) .eqv. dimension == 2, name//': pairs are followed in the plane')
    if (has_wall) call t%equal(n_exact, n_kept, name//': all are exact')
  end subroutine test_pairs

  !> 1 if the next detection goes through the loop over plain arrays, which asks the history that it begins with.
  integer function followed_now(sim)
    type(simulation_t), intent(in) :: sim
    type(simulation_t), pointer :: next

    next => fresh()
    call copy(sim, next)
    call keep_contacts(next%history, next%contacts)
    call exchange_kept(next%history, next%contacts)
    followed_now = 0
    if (.not. are_plain_polygons(next%scene, next%history, next%contacts)) return
    if (are_mostly_kept(next%history)) followed_now = 1
  end function followed_now

  !> Contacts of a pair that a loop over plain arrays follows are those of the general way, which contacts go that carry values.
  subroutine check_general_way(name, followed, general)
    character(len=*), intent(in) :: name
    type(simulation_t), intent(in) :: followed
    type(simulation_t), intent(inout) :: general

    general%contacts%n_carried = 1
    if (allocated(general%contacts%carried)) deallocate (general%contacts%carried)
    allocate (general%contacts%carried(1, size(general%contacts%gap)), source=0.0_wp)
    call t%check(.not. are_plain_polygons(general%scene, general%history, general%contacts), name//': the general way')
    call detect(general%scene, general%pairs, general%history, general%contacts)
    call t%equal(general%contacts%n, followed%contacts%n, name//': as many by the general way')
    if (general%contacts%n /= followed%contacts%n .or. followed%contacts%n == 0) return
    associate (n => followed%contacts%n, one => followed%contacts, other => general%contacts)
      call t%check(all(one%feature(:n) == other%feature(:n)) .and. all(one%body(:, :n) == other%body(:, :n)) .and. &
                   all(one%law(:n) == other%law(:n)) .and. all(one%contactor(:, :n) == other%contactor(:, :n)) .and. &
                   all(one%status(:n) == other%status(:n)) .and. all(one%image(:n) == other%image(:n)), name//': the same contacts')
      call t%near(maxval(abs(one%gap(:n) - other%gap(:n))) + maxval(abs(one%point(:, :n) - other%point(:, :n))) &
                  + maxval(abs(one%normal(:, :n) - other%normal(:, :n))) + maxval(abs(one%impulse(:, :n) - other%impulse(:, :n))) &
                  + max(0.0_wp, maxval(maxval(abs(one%kept(:, :n) - other%kept(:, :n)), 1), one%is_kept(:n) > 0_i1)), 0.0_wp, &
                  rounding, name//': the same places and values')
      call t%check(all(one%is_kept(:n) == other%is_kept(:n)), name//': the same are kept')
    end associate
  end subroutine check_general_way

  !> Copy what detection works on.
  subroutine copy(from, to)
    type(simulation_t), intent(in) :: from
    type(simulation_t), intent(inout) :: to

    to%scene = from%scene
    to%pairs = from%pairs
    to%history = from%history
    to%contacts = from%contacts
  end subroutine copy

  !> Are all contacts the same, bit for bit?
  logical function is_same(one, other)
    type(simulation_t), intent(in) :: one, other

    is_same = one%contacts%n == other%contacts%n
    if (.not. is_same) return
    associate (n => one%contacts%n)
      is_same = .not. (any(abs(one%contacts%gap(:n) - other%contacts%gap(:n)) > 0) .or. &
                       any(abs(one%contacts%point(:, :n) - other%contacts%point(:, :n)) > 0))
    end associate
  end function is_same

  !> Each contact has followed its bodies: its surface points are those of before, up to where one slides along the face.
  subroutine check_followed(name, before, now)
    character(len=*), intent(in) :: name
    type(simulation_t), intent(in) :: before, now
    real(wp) :: apart(2), normal(size(before%contacts%normal, 1), 2), ends(size(before%contacts%point, 1), 2)
    integer :: k, side

    do k = 1, before%contacts%n
      associate (was => before%contacts, is => now%contacts)
        do side = 1, 2
          normal(:, side) = turned(before, now, int(was%body(side, k)), was%normal(:, k))
          ends(:, side) = moved(before, now, int(was%body(side, k)), &
                                was%point(:, k) + merge(0.5_wp, -0.5_wp, side == 1)*was%gap(k)*was%normal(:, k))
        end do
        ! The face is of the one body or of the other.
        do side = 1, 2
          apart(side) = abs(is%gap(k) - dot_product(normal(:, side), ends(:, 1) - ends(:, 2))) &
                        + norm2(is%normal(:, k) - normal(:, side))
        end do
        call t%check(minval(apart) < rounding, name//': the gap is the height of the point over the face')
      end associate
    end do
  end subroutine check_followed

  !> A started run of two bodies near each other.
  subroutine make_pair(random, dimension, has_wall, sim)
    type(random_t), intent(inout) :: random
    integer, intent(in) :: dimension
    logical, intent(in) :: has_wall
    type(simulation_t), pointer, intent(out) :: sim
    real(wp) :: place(3), half(3)
    integer :: b

    sim => fresh()
    if (dimension == 2) call begin_scene(sim%scene, 2, 0.3_wp, alert)
    if (dimension == 3) call begin_space_scene(sim%scene, 2, 0.3_wp, alert)
    do b = 1, 2
      place = 0
      if (b == 2) place(dimension) = random%uniform(1.5_wp, 2.0_wp)
      half = [random%uniform(0.5_wp, 1.0_wp), random%uniform(0.5_wp, 1.0_wp), random%uniform(0.5_wp, 1.0_wp)]
      if (has_wall .and. b == 1) then
        if (dimension == 2) call put_wall(sim%scene, b, 5.0_wp, 0.8_wp, place(:2), 0.01_wp)
        if (dimension == 3) call put_plane(sim%scene, b, [5.0_wp, 5.0_wp, 0.8_wp], place)
      else if (dimension == 2) then
        call put_polygon(sim%scene, b, some_polygon(random, place(:2)))
      else
        call put_box(sim%scene, b, half, place, rotation_by(random_vector(random, 1.0_wp)))
      end if
    end do
    sim%scene%kept_motion = motion
    call begin_run(sim, 1e-3_wp, 1e-8_wp)
    call set_middle(sim)
  end subroutine make_pair

  !> A convex polygon about a place.
  function some_polygon(random, place) result(vertex)
    type(random_t), intent(inout) :: random
    real(wp), intent(in) :: place(2)
    real(wp), allocatable :: vertex(:, :)
    real(wp) :: angle
    integer :: i, n

    n = 3 + int(5*random%uniform(0.0_wp, 0.999_wp))
    allocate (vertex(2, n))
    do i = 1, n
      angle = 2*pi*(real(i, wp) + random%uniform(-0.3_wp, 0.3_wp))/real(n, wp)
      vertex(:, i) = place + [cos(angle), sin(angle)]
    end do
  end function some_polygon

  !> Bodies where they are at the start.
  subroutine set_middle(sim)
    type(simulation_t), intent(inout) :: sim

    associate (bodies => sim%scene%bodies)
      bodies%middle(:sim%scene%dimension, :) = bodies%position
      if (sim%scene%dimension == 2) bodies%middle(3, :) = bodies%angle
      if (sim%scene%dimension == 3) bodies%middle(4:7, :) = bodies%orientation
    end associate
  end subroutine set_middle

  !> Move both bodies far as one, and one against the other by at most a length, all of it where it only slides.
  subroutine move_pair(random, length, sim)
    type(random_t), intent(inout) :: random
    real(wp), intent(in) :: length
    type(simulation_t), intent(inout) :: sim
    real(wp) :: shift(3), vector(3), slide(3), angle, share
    integer :: c

    c = int(sim%contacts%body(1, 1))
    share = random%uniform(0.0_wp, 1.0_wp)
    if (modulo(int(1e6_wp*share), 4) == 0) share = 1
    slide = random_vector(random, share*length)
    ! A turn by w moves points at the distance R by less than R w; a pair that has moved too far slides all the way.
    angle = (1 - share)*length/sim%scene%contactors%reach(sim%contacts%contactor(1, 1))
    if (length > motion*minval(sim%scene%contactors%reach(:2))) slide = random_vector(random, length)
    shift = random_vector(random, 3.0_wp)
    vector = random_vector(random, random%uniform(0.0_wp, 3.0_wp))
    associate (middle => sim%scene%bodies%middle)
      if (sim%scene%dimension == 2) then
        if (abs(slide(1)) + abs(slide(2)) > 0) slide(:2) = slide(:2)*norm2(slide)/norm2(slide(:2))
        middle(1:2, c) = middle(1:2, c) + slide(:2)
        middle(3, c) = middle(3, c) + sign(angle, vector(2))
        call turn_all(middle, shift, vector(1))
      else
        middle(1:3, c) = middle(1:3, c) + slide
        middle(4:7, c) = quaternion_product(rotation_by(random_vector(random, angle)), middle(4:7, c))
        call turn_all_in_space(middle, shift, rotation_by(vector))
      end if
    end associate
  end subroutine move_pair

  !> Move all bodies as one, in the plane.
  subroutine turn_all(middle, shift, angle)
    real(wp), intent(inout) :: middle(:, :)
    real(wp), intent(in) :: shift(3), angle
    integer :: b

    do b = 1, size(middle, 2)
      middle(1:2, b) = shift(:2) + [cos(angle)*middle(1, b) - sin(angle)*middle(2, b), &
                                    sin(angle)*middle(1, b) + cos(angle)*middle(2, b)]
      middle(3, b) = middle(3, b) + angle
    end do
  end subroutine turn_all

  !> The same in space.
  subroutine turn_all_in_space(middle, shift, turn)
    real(wp), intent(inout) :: middle(:, :)
    real(wp), intent(in) :: shift(3), turn(4)
    integer :: b

    do b = 1, size(middle, 2)
      middle(1:3, b) = shift + turned_by(turn, middle(1:3, b))
      middle(4:7, b) = quaternion_product(turn, middle(4:7, b))
    end do
  end subroutine turn_all_in_space

  !> A vector of some length in a random direction.
  function random_vector(random, length) result(vector)
    type(random_t), intent(inout) :: random
    real(wp), intent(in) :: length
    real(wp) :: vector(3)
    integer :: i

    do
      vector = [(random%uniform(-1.0_wp, 1.0_wp), i=1, 3)]
      if (norm2(vector) > 0.1_wp .and. norm2(vector) < 1) exit
    end do
    vector = length/norm2(vector)*vector
  end function random_vector

  !> Place that a point of a body has moved to.
  function moved(from, to, b, point)
    type(simulation_t), intent(in) :: from, to
    integer, intent(in) :: b
    real(wp), intent(in) :: point(:)
    real(wp) :: moved(size(point))

    associate (d => size(point))
      moved = to%scene%bodies%middle(:d, b) + turned(from, to, b, point - from%scene%bodies%middle(:d, b))
    end associate
  end function moved

  !> A vector that has turned with a body.
  function turned(from, to, b, v)
    type(simulation_t), intent(in) :: from, to
    integer, intent(in) :: b
    real(wp), intent(in) :: v(:)
    real(wp) :: turned(size(v)), angle

    associate (was => from%scene%bodies%middle(:, b), is => to%scene%bodies%middle(:, b))
      if (size(v) == 3) then
        turned = turned_by(is(4:7), turned_by([was(4), -was(5:7)], v))
      else
        angle = is(3) - was(3)
        turned = [cos(angle)*v(1) - sin(angle)*v(2), sin(angle)*v(1) + cos(angle)*v(2)]
      end if
    end associate
  end function turned

  !> Packs that come to rest: all steps converge, and detection keeps contacts.
  subroutine test_packs(comm)
    type(comm_t), intent(inout) :: comm

    call test_pack(comm, 'polygons')
    if (can_be_made('polyhedra')) call test_pack(comm, 'polyhedra')
  end subroutine test_packs

  !> One pack.
  subroutine test_pack(comm, name)
    type(comm_t), intent(inout) :: comm
    character(len=*), intent(in) :: name
    character(len=*), parameter :: scene = '[scene]'//new_line('a')
    character(len=:), allocatable :: deck
    type(simulation_t), pointer :: sim
    type(error_t), allocatable :: error
    integer :: n

    sim => fresh()
    deck = pack_deck(name)
    if (index(deck, scene) == 1) deck = deck(len(scene) + 1:)
    deck = scene//'kept_motion = 1e-3'//new_line('a')//deck
    call start_pack(t, comm, name, deck, 1e-4_wp, sim)
    sim%comm = comm
    call decompose(sim, error)
    call t%check(.not. allocated(error), name//': is split')
    call advance_pack(t, name, sim, 200)
    call t%equal(sim%totals%converged_steps, 200, name//': all steps converge')
    n = count(sim%contacts%is_kept(:sim%contacts%n) > 0_i1)
    call sim%comm%sum(n)
    call t%check(n > 0, name//': contacts are kept where grains have come to rest')
  end subroutine test_pack
end program test_kept_contacts
