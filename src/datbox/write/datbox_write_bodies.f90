!> Writes BODIES.DAT and DOF.INI: bodies, their contactors and their state.
!!
!! BODIES.DAT holds eight digits of a place; the displacement of DOF.INI holds what these lose, so that state is kept
!! to some fifteen digits. A node at the very origin would be taken for one to be computed: it is moved off, and the
!! displacement moves it back.
module sg_datbox_write_bodies
  use sg_bodies, only: angle_of, spin_of
  use sg_contactors, only: contactors_t, kind_disk, kind_hollow, kind_point, kind_polygon, kind_segment
  use sg_datbox_bodies, only: body_type
  use sg_datbox_output, only: as_written, finish_file, labelled, node_head, output_t, put, put_steps, real_word, &
                              start_file
  use sg_datbox_write_space, only: check_solid, put_solid, put_solid_contactor, put_solid_state
  use sg_error, only: error_t, fail
  use sg_kinds, only: wp, i4, pi
  use sg_scene, only: scene_t
  use sg_text, only: to_text
  implicit none
  private
  public :: write_bodies, write_state, check_writable

contains

  !> Refuse what the format cannot hold: bodies of no material, and in the plane shifted hollow disks and segments that are
  !! shifted or turned.
  subroutine check_writable(scene, first, list, error)
    type(scene_t), intent(in) :: scene !! scene to write
    integer(i4), intent(in) :: first(:) !! first place of each body in the list
    integer(i4), intent(in) :: list(:) !! contactors grouped by body
    type(error_t), allocatable, intent(out) :: error !! set when something cannot be written
    integer :: b, i, c
    logical :: is_shifted

    do b = 1, scene%bodies%n
      if (scene%bodies%material(b) < 1) then
        call fail(error, 'body '//to_text(b)//' has no material: a DATBOX needs one')
      else if (scene%dimension == 3) then
        call check_solid(scene, b, list(first(b):first(b + 1) - 1), error)
      end if
      if (allocated(error)) return
      if (scene%dimension == 3) cycle
      do i = first(b), first(b + 1) - 1
        c = list(i)
        is_shifted = norm2(scene%contactors%shift(:, c)) > 1e-12_wp*scene%contactors%reach(c)
        select case (scene%contactors%kind(c))
        case (kind_hollow)
          if (is_shifted) call fail(error, 'body '//to_text(b)//': a DATBOX cannot hold a hollow disk off its body''s centre')
        case (kind_segment)
          if (is_shifted) then
            call fail(error, 'body '//to_text(b)//': a DATBOX cannot hold a segment off its body''s centre')
          else if (first(b + 1) - first(b) > 1 .and. abs(scene%contactors%segment_size(3, scene%contactors%row(c))) > 0) then
            call fail(error, 'body '//to_text(b)//': a DATBOX cannot hold a turned segment in a cluster')
          end if
        end select
        if (allocated(error)) return
      end do
    end do
  end subroutine check_writable

  !> Write BODIES.DAT.
  subroutine write_bodies(folder, scene, first, list, materials, colours, error)
    character(len=*), intent(in) :: folder !! DATBOX folder
    type(scene_t), intent(in) :: scene !! scene to write
    integer(i4), intent(in) :: first(:) !! first place of each body in the list
    integer(i4), intent(in) :: list(:) !! contactors grouped by body
    character(len=5), intent(in) :: materials(:) !! names of the materials
    character(len=5), intent(in) :: colours(:) !! names of the colours
    type(error_t), allocatable, intent(inout) :: error !! set when the file cannot be written
    type(output_t) :: output
    character(len=27) :: head
    real(wp) :: radii(2)
    integer :: b, i

    call start_file(output, folder, 'BODIES.DAT')
    call put(output, '! File BODIES')
    if (scene%period > 0) call put(output, '! The period in x is no part of a DATBOX: '//real_word(scene%period))
    if (scene%period_y > 0) call put(output, '! The period in y is no part of a DATBOX: '//real_word(scene%period_y))
    do b = 1, scene%bodies%n
      call put_body(output, scene%dimension, b)
      call put(output, '$blmty')
      if (scene%dimension == 3) then
        call put_solid(output, scene, b, materials(scene%bodies%material(b)))
      else
        radii = 0
        if (scene%bodies%mass(b) > 0) radii = [sqrt(scene%bodies%mass(b)/(pi*scene%materials(scene%bodies%material(b))%density)), &
                                               sqrt(scene%bodies%inertia(b)/scene%bodies%mass(b))]
        ! A mass without extent, which nothing turns, needs a radius of gyration all the same.
        if (.not. radii(2) > 0) radii(2) = radii(1)
        call put(output, labelled('avrd= gyrd= ', radii, ' PLAIN      1  behav  '//materials(scene%bodies%material(b))))
        call put(output, '$nodty')
        call put(output, labelled('coo1= coo2= coo3= ', node_of(scene, first, list, b), node_head))
      end if
      call put(output, '$tacty')
      do i = first(b), first(b + 1) - 1
        write (head, '(t9,i5,a,a)') i - first(b) + 1, '  color  ', colours(scene%contactors%colour(list(i)))
        if (scene%dimension == 3) then
          call put_solid_contactor(output, scene%contactors, int(list(i)), head)
        else
          call put_contactor(output, scene%contactors, int(list(i)), head)
        end if
      end do
      call put(output, '$$$$$$')
    end do
    call finish_file(output, error)
  end subroutine write_bodies

  !> Begin a body's block.
  subroutine put_body(output, dimension, body)
    type(output_t), intent(inout) :: output
    integer, intent(in) :: dimension, body
    character(len=15) :: line

    call put(output, '$bdyty')
    write (line, '(a,a,2x,i7)') ' ', body_type(dimension), body
    call put(output, line)
  end subroutine put_body

  !> Place [m, m] and angle [rad] written as a body's node.
  pure function node_of(scene, first, list, body) result(node)
    type(scene_t), intent(in) :: scene
    integer(i4), intent(in) :: first(:), list(:)
    integer, intent(in) :: body
    real(wp) :: node(3)
    integer :: c

    node = [scene%bodies%position(:, body), angle_of(scene%bodies, body)]
    ! A segment has no angle of its own there: its body turns with it, which nothing else records.
    if (first(body + 1) > first(body)) then
      c = list(first(body))
      if (scene%contactors%kind(c) == kind_segment) node(3) = node(3) + scene%contactors%segment_size(3, scene%contactors%row(c))
    end if
    if (.not. any(abs(node(1:2)) > 0)) node(1) = 1
  end function node_of

  !> Write one contactor with its further lines.
  subroutine put_contactor(output, contactors, contactor, head)
    type(output_t), intent(inout) :: output
    type(contactors_t), intent(in) :: contactors
    integer, intent(in) :: contactor
    character(len=27), intent(inout) :: head
    character(len=46) :: polygon
    real(wp) :: shift(2)
    integer :: row, v

    row = contactors%row(contactor)
    shift = contactors%shift(:, contactor)
    select case (contactors%kind(contactor))
    case (kind_disk)
      head(2:6) = 'DISKx'
      if (any(abs(shift) > 0)) head(2:6) = 'DISKb'
      call put(output, labelled('byrd= ', [contactors%disk_radius(row)], head))
      if (any(abs(shift) > 0)) call put(output, labelled('coo1= coo2= ', shift))
    case (kind_hollow)
      head(2:6) = 'xKSID'
      call put(output, labelled('byrd= ', [contactors%hollow_radius(row)], head))
    case (kind_segment)
      head(2:6) = 'JONCx'
      call put(output, labelled(' ax1=  ax2= ', contactors%segment_size(1:2, row), head))
    case (kind_point)
      head(2:6) = 'PT2Dx'
      call put(output, labelled('coo1= coo2= ', shift, head))
    case (kind_polygon)
      head(2:6) = 'POLYG'
      associate (from => contactors%polygon_first(row), to => contactors%polygon_first(row + 1) - 1)
        write (polygon, '(a,a,i7)') head, '  nb_vertex=', to - from + 1
        call put(output, polygon//'    byrd='//real_word(contactors%reach(contactor)))
        do v = from, to
          call put(output, labelled('coo1= coo2= ', shift + contactors%polygon_vertex(:, v)))
        end do
      end associate
    end select
  end subroutine put_contactor

  !> Write DOF.INI.
  subroutine write_state(folder, scene, first, list, time, step_number, error)
    character(len=*), intent(in) :: folder !! DATBOX folder
    type(scene_t), intent(in) :: scene !! scene to write
    integer(i4), intent(in) :: first(:) !! first place of each body in the list
    integer(i4), intent(in) :: list(:) !! contactors grouped by body
    real(wp), intent(in) :: time !! [s]
    integer, intent(in) :: step_number !! number of steps made
    type(error_t), allocatable, intent(inout) :: error !! set when the file cannot be written
    type(output_t) :: output
    real(wp) :: node(3), wanted(3)
    integer :: b, i

    call start_file(output, folder, 'DOF.INI')
    call put(output, '! DOF')
    call put_steps(output, time, step_number)
    do b = 1, scene%bodies%n
      if (scene%dimension == 3) then
        call put_body(output, scene%dimension, b)
        call put_solid_state(output, scene, b)
        cycle
      end if
      node = node_of(scene, first, list, b)
      wanted = [scene%bodies%position(:, b), node(3)]
      do i = 1, 3
        node(i) = as_written(node(i))
      end do
      call put_body(output, scene%dimension, b)
      call put(output, '$nodty')
      call put(output, labelled('X(1)= X(2)= X(3)= ', wanted - node, node_head))
      call put(output, labelled('V(1)= V(2)= V(3)= ', [scene%bodies%velocity(1:2, b), spin_of(scene%bodies, b)]))
      call put(output, '$$$$$$')
    end do
    call finish_file(output, error)
  end subroutine write_state
end module sg_datbox_write_bodies
