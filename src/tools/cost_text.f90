!> Predicted costs as a table and as one flat JSON object (method: doc/performance.md).
module sg_cost_text
  use sg_cost_model, only: iteration_t, machine_t, prediction_t
  use sg_json, only: json_t
  use sg_kinds, only: wp
  use sg_print, only: print_line
  use sg_text, only: to_text
  implicit none
  private
  public :: print_costs

contains

  !> Print the costs of the pieces, then one line for each number of ranks; or one flat JSON object.
  subroutine print_costs(machine, are_messages_measured, predictions, as_json)
    type(machine_t), intent(in) :: machine !! costs of the pieces
    logical, intent(in) :: are_messages_measured !! by this run, or given?
    type(prediction_t), intent(in) :: predictions(:) !! one for each number of ranks
    logical, intent(in) :: as_json !! as JSON?
    character(len=*), parameter :: nl = new_line('a')
    character(len=:), allocatable :: text
    character(len=200) :: row
    integer :: i

    if (as_json) then
      call print_line(costs_json(machine, are_messages_measured, predictions))
      return
    end if
    text = trim(merge('measured', 'assumed ', are_messages_measured))
    call print_line( &
      'contacts     '//to_text(predictions(1)%contacts)//nl// &
      'gluing       '//to_text(1e9_wp*machine%glue, 3)//' ns per shared grain'//nl// &
      'messages     '//to_text(1e6_wp*machine%messages%latency(), 3)//' us, '// &
        to_text(1e-9_wp*machine%messages%bandwidth(), 3)//' GB/s ('//text//'), '//to_text(nint(machine%item_bytes))// &
        ' bytes per grain; a test every '//to_text(machine%check_every)//' iterations'//nl// &
      '                contacts              shared  neigh-                     ns per      dual                primal'//nl// &
      '   ranks per rank  largest  imbal.    grains  bours  messages       bytes  update        ms  efficiency        ms  '// &
        'efficiency  turns')
    do i = 1, size(predictions)
      associate (p => predictions(i))
        write (row, '(i8,1x,i8,1x,i8,1x,f7.3,1x,i9,1x,i6,1x,i9,1x,i11,1x,f7.2,2(1x,f9.4,1x,f11.3),1x,i6)') &
          p%ranks, p%contacts/p%ranks, p%largest, imbalance(p), p%shared_grains, p%dual%most_neighbours, p%dual%messages, &
          nint(p%dual%bytes), 1e9_wp*p%update, 1e3_wp*p%dual%seconds, p%dual_efficiency, 1e3_wp*p%primal%seconds, &
          p%primal_efficiency, p%primal%colours
        call print_line(trim(row))
      end associate
    end do
  end subroutine print_costs

  !> Contacts of the rank that owns most over the mean.
  pure real(wp) function imbalance(prediction)
    type(prediction_t), intent(in) :: prediction

    imbalance = real(prediction%largest, wp)*real(prediction%ranks, wp)/real(max(1, prediction%contacts), wp)
  end function imbalance

  !> The whole as one flat object; members of a number of ranks begin with it.
  function costs_json(machine, are_messages_measured, predictions) result(text)
    type(machine_t), intent(in) :: machine
    logical, intent(in) :: are_messages_measured
    type(prediction_t), intent(in) :: predictions(:)
    character(len=:), allocatable :: text
    type(json_t) :: json
    character(len=:), allocatable :: ranks
    integer :: i

    call json%add('contacts', predictions(1)%contacts)
    call json%add('glue_seconds', machine%glue)
    call json%add('messages_measured', are_messages_measured)
    call json%add('latency_seconds', machine%messages%latency())
    call json%add('bandwidth_bytes_per_second', machine%messages%bandwidth())
    call json%add('grain_bytes', machine%item_bytes)
    call json%add('check_every', machine%check_every)
    do i = 1, size(predictions)
      associate (p => predictions(i))
        ranks = 'ranks_'//to_text(p%ranks)//'_'
        call json%add(ranks//'largest', p%largest)
        call json%add(ranks//'imbalance', imbalance(p))
        call json%add(ranks//'shared_grains', p%shared_grains)
        call json%add(ranks//'update_seconds', p%update)
        call add_iteration(json, ranks//'dual_', p%dual)
        call json%add(ranks//'dual_efficiency', p%dual_efficiency)
        call add_iteration(json, ranks//'primal_', p%primal)
        call json%add(ranks//'primal_efficiency', p%primal_efficiency)
        call json%add(ranks//'primal_turns', p%primal%colours)
      end associate
    end do
    text = json%text()
  end function costs_json

  !> Members of one method.
  subroutine add_iteration(json, prefix, iteration)
    type(json_t), intent(inout) :: json
    character(len=*), intent(in) :: prefix
    type(iteration_t), intent(in) :: iteration

    call json%add(prefix//'seconds', iteration%seconds)
    call json%add(prefix//'sweep_seconds', iteration%sweep)
    call json%add(prefix//'glue_seconds', iteration%glue)
    call json%add(prefix//'message_seconds', iteration%message)
    call json%add(prefix//'reduction_seconds', iteration%reduction)
    call json%add(prefix//'messages', iteration%messages)
    call json%add(prefix//'bytes', iteration%bytes)
    call json%add(prefix//'neighbours', iteration%most_neighbours)
  end subroutine add_iteration
end module sg_cost_text
