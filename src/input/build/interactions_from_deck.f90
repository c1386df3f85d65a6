!> Interactions: pairs, law and alert distance, from the blocks interaction.
module sg_interactions_from_deck
  use sg_blocks, only: deck_t
  use sg_census, only: census_t
  use sg_colours_from_deck, only: find_colour
  use sg_contactors, only: kind_names, kind_point, n_kinds
  use sg_error, only: diagnostics_t
  use sg_kinds, only: wp
  use sg_laws, only: acts_in_touch, is_link_law
  use sg_laws_from_deck, only: law_of
  use sg_run_options, only: run_options_t
  use sg_scene, only: largest_gravity, scene_t, see_t
  use sg_sees, only: blind_pairs
  use sg_text, only: to_text
  use sg_words, only: choice_index, choices_of
  implicit none
  private
  public :: default_alert, interactions_from_deck, read_law

contains

  !> Add see tables to those that the scene has from a DATBOX, which come first.
  subroutine interactions_from_deck(deck, options, scene, diagnostics)
    type(deck_t), intent(in) :: deck !! checked deck
    type(run_options_t), intent(in) :: options !! options of the run
    type(scene_t), intent(inout) :: scene !! scene with bodies, laws and drives
    type(diagnostics_t), intent(inout) :: diagnostics !! mistakes found
    type(see_t) :: see
    real(wp) :: alert(2)
    integer, allocatable :: contact_laws(:)
    integer :: b, n

    n = deck%count_of('interaction')
    ! The laws of a DATBOX have their see tables.
    if (n == 0 .and. deck%folder_bodies > 0) return
    alert = default_alert(scene, options, deck%absent)
    if (.not. allocated(scene%sees)) allocate (scene%sees(0))
    contact_laws = pack([(b, b=1, size(scene%laws))], [(.not. (is_link_law(scene%laws(b)) .or. &
                                                       is_of_bonds(deck, scene%laws(b)%name)), b=1, size(scene%laws))])
    if (n == 0 .and. size(contact_laws) == 1) then
      see%law = contact_laws(1)
      call set_alert(scene, alert, see)
      scene%sees = [see]
      call warn_of_blind(deck, deck%block_of('law'), scene, diagnostics)
    else if (n == 0 .and. size(contact_laws) > 1) then
      call deck%complain(diagnostics, 'there are several laws: [[interaction]] must give the pairs that each applies to', &
                         deck%block_of('law'))
    else if (size(contact_laws) == 0 .and. scene%bodies%n + deck%absent%n > 1) then
      call deck%warn(diagnostics, 'the deck has no [[law]] of contact: bodies pass through each other', deck%block_of('scene'))
    end if
    do b = 1, deck%n
      if (.not. deck%is_in(b, 'interaction')) cycle
      call read_interaction(deck, b, scene, alert, see, diagnostics)
      call warn_of_short(deck, b, options%time_step*speed_at_start(scene, deck%absent), see%alert, diagnostics)
      scene%sees = [scene%sees, see]
      call warn_of_blind(deck, b, scene, diagnostics)
    end do
  end subroutine interactions_from_deck

  !> Does a block of bonds name a law?
  logical function is_of_bonds(deck, law)
    type(deck_t), intent(in) :: deck
    character(len=*), intent(in) :: law
    integer :: b

    is_of_bonds = .false.
    do b = 1, deck%n
      if (deck%is_in(b, 'bond')) is_of_bonds = is_of_bonds .or. deck%word(b, 'law') == law
    end do
  end function is_of_bonds

  !> One line of the see tables.
  subroutine read_interaction(deck, b, scene, alert, see, diagnostics)
    type(deck_t), intent(in) :: deck
    integer, intent(in) :: b
    type(scene_t), intent(in) :: scene
    real(wp), intent(in) :: alert(2)
    type(see_t), intent(out) :: see
    type(diagnostics_t), intent(inout) :: diagnostics

    see%candidate_kind = choice_index(deck%word(b, 'candidate_shape'), choices_of(kind_names))
    see%antagonist_kind = choice_index(deck%word(b, 'antagonist_shape'), choices_of(kind_names))
    call find_colour(deck, b, 'candidate', deck%word(b, 'candidate'), scene, see%candidate_colour, diagnostics)
    call find_colour(deck, b, 'antagonist', deck%word(b, 'antagonist'), scene, see%antagonist_colour, diagnostics)
    call read_law(deck, b, scene, alert, see, diagnostics)
    if (see%law == 0) return
    if (is_link_law(scene%laws(see%law)) .and. .not. all([see%candidate_kind, see%antagonist_kind] == kind_point)) &
      call deck%complain(diagnostics, 'the law "'//scene%laws(see%law)%name//'" holds between points: candidate_shape and '// &
                         'antagonist_shape must be "point"', b)
  end subroutine read_interaction

  !> Law and alert distances of the line of a block.
  subroutine read_law(deck, b, scene, alert, see, diagnostics)
    type(deck_t), intent(in) :: deck !! checked deck
    integer, intent(in) :: b !! block with the keys "law" and "alert"
    type(scene_t), intent(in) :: scene !! scene with its laws
    real(wp), intent(in) :: alert(2) !! least and longest alert distance where none is given [m]
    type(see_t), intent(inout) :: see !! gets them; law 0 where there is no such law
    type(diagnostics_t), intent(inout) :: diagnostics !! mistakes found

    see%law = law_of(deck, b, scene, diagnostics)
    if (see%law == 0) return
    call set_alert(scene, alert, see)
    if (.not. deck%is_given(b, 'alert')) return
    see%alert = deck%number(b, 'alert')
    see%least_alert = see%alert
  end subroutine read_law

  !> Warn of shapes that the last line of the see tables brings together and that cannot touch. A line that names both kinds
  !! means all bodies but those whose every component is imposed; others are taken to mean grains.
  subroutine warn_of_blind(deck, b, scene, diagnostics)
    type(deck_t), intent(in) :: deck
    integer, intent(in) :: b
    type(scene_t), intent(in) :: scene
    type(diagnostics_t), intent(inout) :: diagnostics
    logical :: blind(n_kinds, n_kinds), names_one_point
    integer :: i, j, line

    line = size(scene%sees)
    if (scene%sees(line)%candidate_kind > 0 .and. scene%sees(line)%antagonist_kind > 0) then
      blind = blind_pairs(scene, line, is_free(scene), deck%absent%looks)
    else
      blind = blind_pairs(scene, line, scene%bodies%is_grain, deck%absent%looks)
    end if
    names_one_point = (scene%sees(line)%candidate_kind == kind_point) .neqv. (scene%sees(line)%antagonist_kind == kind_point)
    do j = 1, n_kinds
      do i = 1, j
        ! A line that names no point does not mean them, and one that names two links them.
        if (any([i, j] == kind_point) .and. .not. names_one_point) cycle
        if (blind(i, j)) call deck%warn(diagnostics, trim(kind_names(i))//' and '//trim(kind_names(j))// &
                                        ' cannot touch: bodies of these shapes pass through each other', b)
      end do
    end do
  end subroutine warn_of_blind

  !> Which bodies have a component that is not imposed?
  pure function is_free(scene)
    type(scene_t), intent(in) :: scene
    logical :: is_free(scene%bodies%n)
    integer :: n_imposed(scene%bodies%n), i

    n_imposed = 0
    do i = 1, size(scene%drives)
      associate (n => n_imposed(scene%drives(i)%body))
        if (scene%drives(i)%is_velocity) n = n + 1
      end associate
    end do
    is_free = n_imposed < scene%bodies%n_velocity
  end function is_free

  !> Alert distances of a pair where none is given: what acts on open contacts is always sought up to the longest.
  pure subroutine set_alert(scene, alert, see)
    type(scene_t), intent(in) :: scene
    real(wp), intent(in) :: alert(2) !! least and longest [m]
    type(see_t), intent(inout) :: see !! with its law

    see%alert = alert(2)
    if (acts_in_touch(scene%laws(see%law))) see%least_alert = alert(1)
  end subroutine set_alert

  !> Least and longest alert distance where none is given [m]. The motion of each step decides between a fiftieth of the radius of
  !! the smallest grain and a tenth of it, or the way in a step of what is fastest at the start, driven, or falls through the whole
  !! scene, if that is longer.
  function default_alert(scene, options, absent) result(alert)
    type(scene_t), intent(in) :: scene !! scene with bodies, laws and drives
    type(run_options_t), intent(in) :: options !! options of the run
    type(census_t), intent(in) :: absent !! bodies that other ranks keep
    real(wp) :: alert(2)
    real(wp) :: smallest, height, fall, low(scene%dimension), high(scene%dimension)
    integer :: c

    alert = 0
    if (scene%contactors%n + absent%n == 0) return
    smallest = absent%smallest
    associate (contactors => scene%contactors, bodies => scene%bodies)
      do c = 1, contactors%n
        if (bodies%is_grain(contactors%body(c)) .and. contactors%kind(c) /= kind_point) &
          smallest = min(smallest, contactors%reach(c))
      end do
      if (smallest >= huge(1.0_wp)) smallest = minval(contactors%reach(:contactors%n))
      low = min(minval(bodies%position, 2), absent%low(:scene%dimension))
      high = max(maxval(bodies%position, 2), absent%high(:scene%dimension))
      height = maxval(high - low) + 2*smallest
    end associate
    ! Fastest free fall: through the whole scene. The number of steps has no part in it: a longer run is the same run.
    fall = sqrt(2*largest_gravity(scene)*height)
    alert = [smallest/50, max(smallest/10, options%time_step*(speed_at_start(scene, absent) + fall))]
  end function default_alert

  !> Largest speed of a body at the start or driven [m/s].
  real(wp) function speed_at_start(scene, absent) result(speed)
    type(scene_t), intent(in) :: scene
    type(census_t), intent(in) :: absent
    integer :: i

    speed = absent%speed
    if (scene%bodies%n > 0) speed = max(speed, sqrt(maxval(sum(scene%bodies%velocity(:scene%dimension, :)**2, 1))))
    do i = 1, size(scene%drives)
      if (.not. scene%drives(i)%is_velocity .or. scene%drives(i)%component > scene%dimension) cycle
      speed = max(speed, scene%drives(i)%value%largest())
    end do
  end function speed_at_start

  !> Warn of an alert distance that the fastest body passes in a step: what it meets is seen when it is too late.
  subroutine warn_of_short(deck, b, way, alert, diagnostics)
    type(deck_t), intent(in) :: deck
    integer, intent(in) :: b
    real(wp), intent(in) :: way, alert
    type(diagnostics_t), intent(inout) :: diagnostics

    if (alert >= way .or. .not. deck%is_given(b, 'alert')) return
    call deck%warn(diagnostics, 'the fastest body moves by '//to_text(way, 3)//' m in a step, farther than the alert '// &
                   'distance of '//to_text(alert, 3)//' m: it may pass into others before a contact is seen', b, 'alert')
  end subroutine warn_of_short
end module sg_interactions_from_deck
