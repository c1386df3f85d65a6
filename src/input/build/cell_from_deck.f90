!> The periodic cell of a deck, and what cannot stand next to it.
module sg_cell_from_deck
  use sg_blocks, only: deck_t
  use sg_error, only: diagnostics_t
  use sg_kinds, only: wp
  use sg_laws, only: is_cohesive_zone, is_link_law
  use sg_periodic_cell, only: component_xy
  use sg_run_options, only: run_options_t
  use sg_scene, only: scene_t
  use sg_time_function_from_deck, only: read_formula
  implicit none
  private
  public :: cell_from_deck, check_cell

  !> Keys of rates and stresses, in the order of the components of the cell
  character(len=14), parameter :: rate_keys(4) = ['strain_rate_xx', 'strain_rate_yy', 'strain_rate_zz', 'shear_rate    ']
  character(len=12), parameter :: stress_keys(4) = ['stress_xx   ', 'stress_yy   ', 'stress_zz   ', 'shear_stress']

contains

  !> Read the cell; the periods of the scene are then its lengths, and there is no gravity unless the deck gives some, which is
  !! refused.
  subroutine cell_from_deck(deck, scene, diagnostics)
    type(deck_t), intent(inout) :: deck !! checked deck
    type(scene_t), intent(inout) :: scene !! scene of which the dimension is set
    type(diagnostics_t), intent(inout) :: diagnostics !! mistakes found
    real(wp) :: length(3)
    integer :: b, i

    b = deck%block_of('cell')
    if (.not. deck%is_given(b, 'size')) then
      ! Effective decks hold the defaults.
      do i = 1, size(rate_keys)
        if (deck%is_given(b, trim(stress_keys(i)))) &
          call deck%complain(diagnostics, 'a periodic cell needs its "size"', b, trim(stress_keys(i)))
        if (.not. deck%is_given(b, trim(rate_keys(i)))) cycle
        call read_formula(deck, b, trim(rate_keys(i)), scene%cell%imposed(i), diagnostics)
        if (.not. scene%cell%imposed(i)%is_zero()) &
          call deck%complain(diagnostics, 'a periodic cell needs its "size"', b, trim(rate_keys(i)))
      end do
      return
    end if
    call check_scene(deck, deck%block_of('scene'), diagnostics)
    length = deck%vector(b, 'size')
    if (any(length(:scene%dimension) <= 0)) then
      call deck%complain(diagnostics, 'the lengths of the cell must be above 0', b, 'size')
      return
    end if
    call scene%cell%begin(length)
    do i = 1, component_xy
      if (i == 3 .and. scene%dimension == 2) cycle
      call read_formula(deck, b, trim(rate_keys(i)), scene%cell%imposed(i), diagnostics)
      if (.not. deck%is_given(b, trim(stress_keys(i)))) cycle
      if (.not. scene%cell%imposed(i)%is_zero()) call deck%complain(diagnostics, 'give either "'//trim(rate_keys(i))//'" or "'// &
                                                                    trim(stress_keys(i))//'"', b, trim(stress_keys(i)))
      scene%cell%imposed(i)%constant = 0
      call read_formula(deck, b, trim(stress_keys(i)), scene%cell%imposed(i), diagnostics)
      scene%cell%is_stress(i) = .true.
    end do
    scene%cell%inertia = deck%number(b, 'inertia')
    scene%period = length(1)
    scene%period_y = length(2)
    scene%period_z = length(3)
    scene%bodies%has_cell = .true.
  end subroutine cell_from_deck

  !> Refuse keys of the scene that a cell replaces, and gravity, under which all of it would fall for ever.
  subroutine check_scene(deck, b, diagnostics)
    type(deck_t), intent(inout) :: deck
    integer, intent(in) :: b
    type(diagnostics_t), intent(inout) :: diagnostics
    character(len=*), parameter :: no_weight = 'there is no gravity in a periodic cell: nothing would carry its weight'
    integer :: i

    if (deck%is_given(b, 'period_x')) call deck%complain(diagnostics, 'the periods are those of cell.size', b, 'period_x')
    if (deck%is_given(b, 'period_y')) call deck%complain(diagnostics, 'the periods are those of cell.size', b, 'period_y')
    do i = 1, deck%n
      if (deck%is_in(i, 'gravity')) call deck%complain(diagnostics, no_weight, i)
    end do
    if (.not. deck%is_given(b, 'gravity')) then
      call deck%give_numbers(b, 'gravity', spread(0.0_wp, 1, deck%dimension))
    else if (any(abs(deck%vector(b, 'gravity')) > 0)) then
      call deck%complain(diagnostics, no_weight, b, 'gravity')
    end if
  end subroutine check_scene

  !> Refuse what a cell cannot hold: bodies that are no grains, links, cohesive zones, substeps.
  subroutine check_cell(deck, options, scene, diagnostics)
    type(deck_t), intent(in) :: deck !! checked deck
    type(run_options_t), intent(in) :: options !! options of the run
    type(scene_t), intent(in) :: scene !! scene with its bodies, laws and drives
    type(diagnostics_t), intent(inout) :: diagnostics !! mistakes found
    integer :: b, i

    if (.not. scene%cell%is_on) return
    b = deck%block_of('cell')
    if (size(scene%drives) + size(scene%pressures) > 0 .or. .not. all(scene%bodies%is_grain)) &
      call deck%complain(diagnostics, 'a periodic cell holds free grains alone: no wall, no fixed, driven or pressed body', b)
    do i = 1, size(scene%laws)
      if (is_cohesive_zone(scene%laws(i)) .or. is_link_law(scene%laws(i))) &
        call deck%complain(diagnostics, 'the law "'//scene%laws(i)%name//'" is not available in a periodic cell', b)
    end do
    if (any(scene%cell%is_stress)) call check_solver(deck, options, diagnostics)
    do i = 1, size(rate_keys)
      if (scene%cell%is_stress(i)) cycle
      if (scene%cell%imposed(i)%largest()*options%time_step > 1) &
        call deck%complain(diagnostics, 'the cell strains by more than 1 in a step: take a smaller step or rate', b, &
                           trim(rate_keys(i)))
    end do
    if (options%substeps > 1) call deck%complain(diagnostics, 'a periodic cell does not run in substeps', deck%block_of('time'), &
                                                 'substeps')
  end subroutine check_cell

  !> Refuse what imposed stress cannot have: methods that are no sweeps, alone or between ranks.
  subroutine check_solver(deck, options, diagnostics)
    type(deck_t), intent(in) :: deck
    type(run_options_t), intent(in) :: options
    type(diagnostics_t), intent(inout) :: diagnostics

    if (.not. any(options%solver%method == [character(len=8) :: 'nlgs', 'nesterov'])) &
      call deck%complain(diagnostics, 'imposed stress in a periodic cell needs the method nesterov or nlgs', &
                         deck%block_of('solver'), 'method')
    if (deck%ranks > 1 .and. .not. any(options%partition%gluing == [character(len=8) :: 'dual', 'primal', 'momentum'])) &
      call deck%complain(diagnostics, 'imposed stress in a periodic cell needs the gluing dual, primal or momentum', &
                         deck%block_of('partition'), 'gluing')
  end subroutine check_solver
end module sg_cell_from_deck
