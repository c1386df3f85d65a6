!> A scene from the blocks of a deck.
module sg_scene_from_deck
  use sg_blocks, only: deck_t
  use sg_bodies_from_deck, only: bodies_from_deck
  use sg_bonds_from_deck, only: bonds_from_deck
  use sg_called_bodies, only: numbers_called
  use sg_cell_from_deck, only: cell_from_deck, check_cell
  use sg_datbox, only: check_folder_sees, folder_sees_t, read_datbox_share
  use sg_datbox_walls, only: driven_bodies
  use sg_drives_from_deck, only: drives_from_deck
  use sg_error, only: diagnostics_t
  use sg_gravity_from_deck, only: gravity_from_deck
  use sg_interactions_from_deck, only: interactions_from_deck
  use sg_kinds, only: wp, i4
  use sg_laws_from_deck, only: laws_from_deck, materials_from_deck
  use sg_link_network, only: link_by_distance
  use sg_links, only: locate_links
  use sg_joints_from_deck, only: joints_from_deck
  use sg_links_from_deck, only: links_from_deck
  use sg_passages_from_deck, only: passages_from_deck
  use sg_rolling_checks, only: check_rolling
  use sg_rolling_from_deck, only: rolling_from_deck
  use sg_run_options, only: run_options_t
  use sg_scene, only: scene_t
  use sg_share, only: share_t
  use sg_start_checks, only: check_range
  use sg_start_overlaps, only: find_overlaps, overlaps_t, report_overlaps
  use sg_system, only: file_exists
  use sg_text, only: to_text
  use sg_time_function_from_deck, only: path_in_deck
  use sg_unused_laws, only: laws_of_links, warn_of_unused_laws
  implicit none
  private
  public :: scene_from_deck

contains

  !> Build the scene; what is wrong in it goes to `diagnostics`. A deck adds to the scene of its DATBOX, if it names one: bodies,
  !! materials and laws stand behind those of the folder, interactions behind its see tables.
  subroutine scene_from_deck(deck, options, scene, diagnostics)
    type(deck_t), intent(inout) :: deck !! checked deck
    type(run_options_t), intent(in) :: options !! options read from it
    type(scene_t), intent(inout) :: scene !! scene to fill
    type(diagnostics_t), intent(inout) :: diagnostics !! mistakes and warnings found
    type(share_t) :: share
    type(folder_sees_t) :: sees
    logical :: has_folder
    integer :: b, points

    b = deck%block_of('scene')
    scene%dimension = deck%dimension
    ! Links of a DATBOX join nearest images.
    scene%period = deck%number(b, 'period_x')
    if (scene%dimension == 3) scene%period_y = deck%number(b, 'period_y')
    scene%shrink = deck%number(b, 'shrink_faces')
    scene%kept_motion = deck%number(b, 'kept_motion')
    scene%bears_moments = deck%bears_moments
    call cell_from_deck(deck, scene, diagnostics)
    if (diagnostics%count() > 0) return
    share%rank = deck%rank
    share%ranks = deck%ranks
    has_folder = deck%is_given(b, 'datbox')
    if (has_folder) call take_folder(deck, b, scene, share, sees, diagnostics)
    if (diagnostics%count() > 0) return
    call take_gravity(deck, b, has_folder, scene)
    points = share%points%n
    call gravity_from_deck(deck, scene, diagnostics)
    call materials_from_deck(deck, scene, diagnostics)
    if (has_folder) call rolling_from_deck(deck, scene, diagnostics)
    call laws_from_deck(deck, scene, diagnostics)
    call check_rolling(deck, options, scene, diagnostics)
    call bodies_from_deck(deck, scene, share, diagnostics)
    if (diagnostics%count() > 0) return
    call drives_from_deck(deck, scene, diagnostics)
    call interactions_from_deck(deck, options, scene, diagnostics)
    if (diagnostics%count() == 0) call warn_of_unused_laws(deck, scene, diagnostics)
    if (has_folder) call check_folder_sees(scene, share%census, sees, laws_of_links(deck, scene), diagnostics)
    call bonds_from_deck(deck, options, scene, diagnostics)
    if (diagnostics%count() == 0) call link_by_distance(scene, share%points, linked=points)
    call links_from_deck(deck, scene, diagnostics)
    call joints_from_deck(deck, scene, diagnostics)
    call locate_links(scene%links, scene%contactors)
    if (has_folder) call wrap(scene)
    call passages_from_deck(deck, scene, diagnostics)
    call check_cell(deck, options, scene, diagnostics)
    call check_start(deck, scene, diagnostics)
  end subroutine scene_from_deck

  !> Read the scene of a DATBOX folder.
  subroutine take_folder(deck, block, scene, share, sees, diagnostics)
    type(deck_t), intent(inout) :: deck
    integer, intent(in) :: block
    type(scene_t), intent(inout) :: scene
    type(share_t), intent(inout) :: share
    type(folder_sees_t), intent(out) :: sees
    type(diagnostics_t), intent(inout) :: diagnostics
    character(len=:), allocatable :: folder

    folder = path_in_deck(deck, deck%word(block, 'datbox'))
    if (.not. file_exists(folder//'/.')) then
      call deck%complain(diagnostics, 'there is no folder "'//folder//'"', block, 'datbox')
      return
    end if
    ! Bodies of a folder go by their numbers; those of the deck have none yet.
    call numbers_called(deck, share%common)
    share%notes_states = deck%ranks > 1 .and. deck%count_of('interaction') + deck%count_of('bond') > 0
    call read_datbox_share(folder, scene, share, sees, diagnostics)
    if (diagnostics%count() > 0) return
    if (scene%bodies%dimension /= deck%dimension) then
      call deck%complain(diagnostics, 'the bodies of the folder have '//to_text(scene%bodies%dimension)//' dimensions, not '// &
                         to_text(deck%dimension), block, 'dimension')
      return
    end if
    deck%driven = driven_bodies(scene)
  end subroutine take_folder

  !> Take the gravity of the deck, or that of the folder where the deck gives none.
  subroutine take_gravity(deck, block, has_folder, scene)
    type(deck_t), intent(inout) :: deck
    integer, intent(in) :: block
    logical, intent(in) :: has_folder
    type(scene_t), intent(inout) :: scene

    if (has_folder .and. .not. deck%is_given(block, 'gravity')) then
      call deck%give_numbers(block, 'gravity', scene%gravity(:deck%dimension))
    else
      scene%gravity = deck%vector(block, 'gravity')
    end if
  end subroutine take_gravity

  !> Check range and overlaps at the start. Bodies of a DATBOX may lie and overlap as they do. Where each rank has a part of
  !! the scene, all check it together.
  subroutine check_start(deck, scene, diagnostics)
    type(deck_t), intent(in) :: deck
    type(scene_t), intent(inout) :: scene
    type(diagnostics_t), intent(inout) :: diagnostics
    type(overlaps_t) :: overlaps

    if (deck%ranks > 1 .or. scene%bodies%n == deck%folder_bodies) return
    if (deck%folder_bodies == 0) call check_range(deck, scene, diagnostics)
    if (diagnostics%count() > 0) return
    call find_overlaps(scene, 0, deck, overlaps)
    call report_overlaps(deck, overlaps, diagnostics)
  end subroutine check_start

  !> Put the grains of a periodic scene within the period, as LMGC90 does when it starts.
  subroutine wrap(scene)
    type(scene_t), intent(inout) :: scene
    integer :: i

    associate (bodies => scene%bodies)
      do i = 1, bodies%n
        if (.not. bodies%is_grain(i)) cycle
        if (scene%period > 0) then
          bodies%crossings(i) = periods_in(bodies%position(1, i)/scene%period)
          bodies%position(1, i) = modulo(bodies%position(1, i), scene%period)
        end if
        if (scene%period_y > 0) then
          bodies%crossings_y(i) = periods_in(bodies%position(2, i)/scene%period_y)
          bodies%position(2, i) = modulo(bodies%position(2, i), scene%period_y)
        end if
        if (scene%period_z > 0) then
          bodies%crossings_z(i) = periods_in(bodies%position(3, i)/scene%period_z)
          bodies%position(3, i) = modulo(bodies%position(3, i), scene%period_z)
        end if
      end do
    end associate
  end subroutine wrap

  !> Whole periods in a length over the period, as far as they can be counted.
  pure integer(i4) function periods_in(ratio)
    real(wp), intent(in) :: ratio
    real(wp), parameter :: most = 2e9_wp

    periods_in = floor(max(-most, min(most, ratio)), i4)
  end function periods_in
end module sg_scene_from_deck
