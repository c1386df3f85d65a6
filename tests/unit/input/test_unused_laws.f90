!> Interactions that hold between no shapes, laws that none names, shapes that touch nothing: against brute force over all pairs of
!! contactors of random scenes, and the warnings that decks get.
program test_unused_laws
  use harness, only: tests_t
  use sg_contactors, only: kind_sphere, n_kinds
  use sg_error, only: diagnostics_t
  use sg_kinds, only: wp
  use sg_random, only: random_t
  use sg_run_options, only: run_options_t
  use sg_scene, only: colour_index, scene_t, see_t
  use sg_sees, only: see_between, see_of
  use sg_sees_used, only: find_uses, fits_blind, fits_nothing, is_spare, is_used, see_uses_t
  use sg_text, only: to_text
  use written_files, only: read_deck_text
  implicit none
  character(len=*), parameter :: nl = new_line('a')
  !> Nine lines with two laws, and bodies from line 10: a floor, a disk and a polygon
  character(len=*), parameter :: head = '[time]'//nl//'step = 1e-3'//nl//'steps = 10'//nl//'[[material]]'//nl// &
    'name = "stone"'//nl//'density = 2000'//nl//'[[law]]'//nl//'name = "rough"'//nl//'friction = 0.5'//nl
  character(len=*), parameter :: floor = '[[wall]]'//nl//'from = [-5, -2]'//nl//'to = [5, -2]'//nl//'thickness = 0.1'//nl
  character(len=*), parameter :: disk = '[[body]]'//nl//'shape = "disk"'//nl//'radius = 0.5'//nl
  character(len=*), parameter :: brick = '[[body]]'//nl//'shape = "polygon"'//nl// &
                                         'vertices = [[3, 0], [4, 0], [4, 1], [3, 1]]'//nl//'colour = "red"'//nl
  character(len=*), parameter :: rough = 'law = "rough"'//nl, meet = '[[interaction]]'//nl
  integer, parameter :: n_scenes = 400
  !> What a line does that any other hides
  integer, parameter :: hidden = 1
  type(tests_t) :: t

  call test_random_scenes()
  call test_decks()
  call t%finish()

contains

  !> What lines do in random scenes, of one rank and of one that holds counts of others' bodies: as found by a search over
  !! all pairs of contactors.
  subroutine test_random_scenes()
    type(random_t) :: random
    type(scene_t) :: scene
    type(see_uses_t) :: uses, shared
    integer, allocatable :: none(:, :), others(:, :), expected(:), alone(:, :)
    integer :: i, seen(is_spare:hidden), found

    call random%seed(20261122)
    seen = 0
    do i = 1, n_scenes
      call make_scene(random, scene)
      call expect_uses(scene, expected, alone)
      call find_uses(scene, none, uses)
      call t%check(all(min(uses%line, hidden) == expected), 'lines of scene '//to_text(i))
      call t%check(size(uses%alone, 2) == size(alone, 2), 'lonely shapes of scene '//to_text(i))
      if (size(uses%alone) == size(alone)) call t%check(all(uses%alone == alone), 'which lonely shapes of scene '//to_text(i))
      do found = is_spare, hidden
        if (any(expected == found)) seen(found) = seen(found) + 1
      end do
      call give_away(scene, others)
      call find_uses(scene, others, shared)
      call t%check(all(min(shared%line, hidden) == expected), 'lines of scene '//to_text(i)//' with bodies of other ranks')
    end do
    call t%check(all(seen >= n_scenes/100), 'scenes of all kinds are met')
  end subroutine test_random_scenes

  !> A few contactors of few kinds and colours, and lines that name some of them.
  subroutine make_scene(random, scene)
    type(random_t), intent(inout) :: random
    type(scene_t), intent(out) :: scene
    character(len=*), parameter :: colours = 'abc'
    integer :: i, n, colour

    do i = 1, len(colours)
      call colour_index(scene, colours(i:i), colour)
    end do
    n = draw(random, 1, 6)
    call scene%bodies%allocate(n, 2)
    scene%contactors%n = n
    scene%contactors%body = [(draw(random, 1, n), i=1, n)]
    scene%contactors%kind = [(draw(random, 1, kind_sphere - 1), i=1, n)]
    scene%contactors%colour = [(draw(random, 1, len(colours)), i=1, n)]
    scene%bodies%is_grain = .true.
    allocate (scene%sees(draw(random, 1, 4)), scene%laws(1))
    do i = 1, size(scene%sees)
      scene%sees(i)%law = 1
      scene%sees(i)%candidate_kind = draw(random, 0, kind_sphere - 1)*draw(random, 0, 1)
      scene%sees(i)%antagonist_kind = draw(random, 0, kind_sphere - 1)*draw(random, 0, 1)
      scene%sees(i)%candidate_colour = draw(random, 0, len(colours))*draw(random, 0, 1)
      scene%sees(i)%antagonist_colour = draw(random, 0, len(colours))*draw(random, 0, 1)
    end do
  end subroutine make_scene

  !> A whole number within bounds.
  integer function draw(random, low, high)
    type(random_t), intent(inout) :: random
    integer, intent(in) :: low, high

    draw = max(low, min(high, nint(random%uniform(real(low, wp) - 0.5_wp, real(high, wp) + 0.5_wp))))
  end function draw

  !> What each line does, and the shapes that nothing holds for, pair of contactors by pair.
  subroutine expect_uses(scene, use, alone)
    type(scene_t), intent(in) :: scene
    integer, allocatable, intent(out) :: use(:), alone(:, :)
    logical :: could(scene%contactors%n), does(scene%contactors%n)
    integer :: i, j, line, holder, kind, colour

    allocate (use(size(scene%sees)), source=fits_nothing)
    could = .false.
    does = .false.
    do line = 1, size(use)
      do i = 1, scene%contactors%n
        do j = 1, scene%contactors%n
          if (scene%contactors%body(i) == scene%contactors%body(j)) cycle
          holder = see_between(scene, i, j)
          could(i) = could(i) .or. may_touch(scene, i, j)
          does(i) = does(i) .or. holder > 0
          if (.not. fits(scene, line, i, j)) cycle
          if (holder == line) use(line) = is_used
          if (holder == 0 .and. use(line) == fits_nothing) use(line) = fits_blind
          if (holder < 1 .or. holder >= line .or. use(line) == is_used) cycle
          if (.not. is_part(scene%sees(holder), scene%sees(line))) use(line) = hidden
          if (use(line) /= hidden) use(line) = is_spare
        end do
      end do
    end do
    allocate (alone(2, 0))
    do colour = 1, size(scene%colours)
      do kind = 1, n_kinds
        associate (look => scene%contactors%kind == kind .and. scene%contactors%colour == colour)
          if (.not. any(look .and. could) .or. any(look .and. does)) cycle
          alone = reshape([alone, kind, colour], [2, size(alone, 2) + 1])
        end associate
      end do
    end do
  end subroutine expect_uses

  !> Does a line fit but part of what another one fits? Tried on all kinds and colours.
  logical function is_part(see, general)
    type(see_t), intent(in) :: see, general
    logical :: of_see, of_general, is_all
    integer :: kinds(2), colours(2), i, j, k, l
    type(see_t) :: one(1), other(1)

    one = see
    other = general
    is_all = .true.
    is_part = .true.
    do i = 1, kind_sphere - 1
      do j = 1, kind_sphere - 1
        do k = 1, 4
          do l = 1, 4
            kinds = [i, j]
            colours = [k, l]
            of_see = see_of(one, kinds, colours) > 0
            of_general = see_of(other, kinds, colours) > 0
            is_part = is_part .and. (of_general .or. .not. of_see)
            is_all = is_all .and. (of_see .or. .not. of_general)
          end do
        end do
      end do
    end do
    is_part = is_part .and. .not. is_all
  end function is_part

  !> Does a line fit two contactors in either order?
  logical function fits(scene, line, i, j)
    type(scene_t), intent(in) :: scene
    integer, intent(in) :: line, i, j

    associate (see => scene%sees(line))
      fits = side(scene, i, see%candidate_kind, see%candidate_colour) .and. &
             side(scene, j, see%antagonist_kind, see%antagonist_colour)
      if (.not. fits) &
        fits = side(scene, j, see%candidate_kind, see%candidate_colour) .and. &
               side(scene, i, see%antagonist_kind, see%antagonist_colour)
    end associate
  end function fits

  !> Does one side of a line fit a contactor?
  logical function side(scene, c, kind, colour)
    type(scene_t), intent(in) :: scene
    integer, intent(in) :: c, kind, colour

    side = any(kind == [0, int(scene%contactors%kind(c))]) .and. any(colour == [0, int(scene%contactors%colour(c))])
  end function side

  !> Could two contactors touch if a line were there for them?
  logical function may_touch(scene, i, j)
    type(scene_t), intent(in) :: scene
    integer, intent(in) :: i, j
    type(scene_t) :: open

    allocate (open%sees(1))
    may_touch = see_of(open%sees, int(scene%contactors%kind([i, j])), int(scene%contactors%colour([i, j]))) > 0
  end function may_touch

  !> Take the last contactor of a scene out, as one that another rank keeps.
  subroutine give_away(scene, others)
    type(scene_t), intent(inout) :: scene
    integer, allocatable, intent(out) :: others(:, :)

    associate (n => scene%contactors%n)
      others = reshape(int([scene%contactors%kind(n), scene%contactors%colour(n), scene%contactors%body(n), &
                            scene%contactors%body(n)]), [4, 1])
      n = n - 1
    end associate
  end subroutine give_away

  !> Warnings of decks: their words and lines; spare things that are no mistake get none.
  subroutine test_decks()
    character(len=*), parameter :: both = head//floor//disk

    call expect('the only law', both, '', 0)
    call expect('a general interaction', both//meet, '', 0)
    call expect('special before general', both//meet//'antagonist = "wall"'//nl//meet, '', 0)
    call expect('general before special', both//meet//meet//'antagonist = "wall"'//nl, &
                'an earlier interaction, of line 17, takes all shapes', 18)
    call expect('no such shape', both//meet//meet//'candidate_shape = "polygon"'//nl, 'fits no two shapes of the scene', 18)
    call expect('no such shape twice', both//meet//meet//'candidate_shape = "polygon"'//nl//meet// &
                'antagonist_shape = "hollow disk"'//nl, 'fits no two shapes', 18, times=2)
    call expect('one wall against itself', both//meet//meet//'candidate = "wall"'//nl//'antagonist = "wall"'//nl, 'fits no two', 18)
    call expect('a law that no interaction names', both//'[[law]]'//nl//'name = "smooth"'//nl//meet//rough, &
                'no interaction, no link and no bond names this law', 17)
    call expect('a law of a link', both//'[[law]]'//nl//'name = "rope"'//nl//'kind = "RIGID_WIRE"'//nl//meet//rough// &
                '[[link]]'//nl//'bodies = [1, 2]'//nl//'law = "rope"'//nl, '', 0)
    call expect('a shape that no interaction fits', both//brick//meet//'candidate_shape = "disk"'//nl// &
                'antagonist = "wall"'//nl, 'no interaction fits this shape, which touches nothing: polygon of colour "red"', 21)
    call expect('a body alone', head//disk//meet//'candidate = "grain"'//nl, '', 0)
  end subroutine test_decks

  !> Read a deck: it is right, and its one warning holds `fragment`, at `line`, and stands for `times` such ones; no warning where
  !! `fragment` is empty.
  subroutine expect(name, text, fragment, line, times)
    character(len=*), intent(in) :: name, text, fragment
    integer, intent(in) :: line
    integer, intent(in), optional :: times
    type(scene_t) :: scene
    type(run_options_t) :: options
    type(diagnostics_t) :: diagnostics

    call read_deck_text(text, scene, options, diagnostics)
    call t%equal(diagnostics%count(), 0, name//' is right')
    call t%check(allocated(diagnostics%warnings) .eqv. fragment /= '', name//': a warning, or none')
    if (.not. allocated(diagnostics%warnings)) return
    call t%equal(size(diagnostics%warnings), 1, name//': one warning')
    call t%check(index(diagnostics%warnings(1)%message, fragment) > 0, name//': '//diagnostics%warnings(1)%message)
    call t%equal(diagnostics%warnings(1)%line, line, name//': line')
    if (present(times)) call t%equal(diagnostics%warnings(1)%count, times, name//': times')
  end subroutine expect
end program test_unused_laws
