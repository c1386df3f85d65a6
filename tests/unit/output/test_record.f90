!> What a run writes down: record.csv, run.json, progress and the verdict.
program test_record
  use harness, only: tests_t
  use, intrinsic :: ieee_arithmetic, only: ieee_positive_inf, ieee_quiet_nan, ieee_value
  use sg_comm, only: comm_t
  use sg_error, only: error_t, exit_output
  use sg_json, only: json_t
  use sg_kinds, only: wp, i8, pi
  use sg_measures, only: measures_t, unmeasured
  use sg_numbers, only: write_numbers
  use sg_progress, only: add_recent, duration_text, progress_t
  use sg_record, only: record_columns, record_t
  use sg_report, only: report_t
  use sg_run_options, only: run_options_t
  use sg_run_summary, only: run_done, run_summary_t, write_run_summary
  use sg_scene, only: scene_t
  use sg_system, only: file_exists, is_link, remove_file
  use sg_text, only: read_lines, text_t, to_text
  use sg_text_files, only: append_text, create_text, overwrite_text, replace_file
  use sg_totals, only: totals_t
  use sg_verdict, only: print_verdict
  implicit none
  character(len=*), parameter :: nl = new_line('a')
  type(tests_t) :: t

  call test_json()
  call test_text_files()
  call test_rows()
  call test_rows_in_space()
  call test_restart()
  call test_full_disk()
  call test_summary()
  call test_summary_in_space()
  call test_verdict()
  call test_progress()
  call test_recent_steps()
  call t%finish()

contains

  !> The columns that scripts rely on, in their order.
  function promised_columns() result(names)
    character(len=:), allocatable :: names

    names = 'step,time,contacts,active_contacts,sweeps,contact_updates,converged,criterion,e1,e2,e8,violation,'// &
            'cpu_seconds,wall_seconds,cpu_predict,cpu_detect,cpu_assemble,cpu_solve,cpu_update,cpu_measure,cpu_output,'// &
            'kinetic_energy,potential_energy,external_work,drive_work,friction_loss,impact_loss,energy_closure,'// &
            'mean_penetration,max_penetration,volume_error,compactness,coordination,coordination_without_rattlers,'// &
            'single_contacts,double_contacts,triple_contacts,mean_velocity,max_velocity,inertia_number,pressure,floor_share'
  end function promised_columns

  !> A number that is none.
  real(wp) function nan()
    nan = ieee_value(nan, ieee_quiet_nan)
  end function nan

  !> Commas of a line.
  integer function commas(line)
    character(len=*), intent(in) :: line
    integer :: i

    commas = count([(line(i:i) == ',', i=1, len(line))])
  end function commas

  !> Does Python read the file, and agree with a condition on the object `run`? True, and told, without Python.
  logical function python_agrees(file, condition)
    character(len=*), intent(in) :: file, condition
    integer :: status

    call execute_command_line('command -v python3 > /dev/null', exitstat=status)
    python_agrees = .true.
    if (status /= 0) then
      write (*, '(a)') 'skipped: no python3 to read '//file
      return
    end if
    call execute_command_line('python3 -c "import json; run = json.load(open('''//file//''')); assert '//condition// &
                              '" 2> /dev/null', exitstat=status)
    python_agrees = status == 0
  end function python_agrees

  subroutine test_json()
    type(json_t) :: json
    type(error_t), allocatable :: error
    character(len=*), parameter :: odd = 'a "b" \c'//achar(9)//achar(1)//char(195)//char(169)//char(255)

    call t%check(json%text() == '{'//nl//'}', 'an empty object')
    call json%add('text', odd)
    call json%add('number', 0.1_wp)
    call json%add('nothing', nan())
    call json%add('endless', ieee_value(1.0_wp, ieee_positive_inf))
    call json%add('small', -1e-200_wp)
    call json%add('yes', .true.)
    call json%add('whole', -7)
    call t%check(index(json%text(), '"text": "a \"b\" \\c\u0009\u0001'//char(195)//char(169)//'?"') > 0, 'escapes')
    call t%check(index(json%text(), '"nothing": null,') > 0 .and. index(json%text(), '"endless": null,') > 0, &
                 'what is not finite is null')
    call replace_file('odd.json', json%text(), error)
    call t%check(.not. allocated(error), 'a JSON file is written')
    call t%check(python_agrees('odd.json', 'run[''number''] == 0.1 and run[''small''] == -1e-200 and run[''yes''] is True '// &
                               'and run[''whole''] == -7 and run[''text''][-1] == ''?'' and len(run) == 7'), &
                 'another reader agrees')
  end subroutine test_json

  subroutine test_text_files()
    type(error_t), allocatable :: error
    type(text_t), allocatable :: lines(:)

    call replace_file('lines.txt', 'one'//nl, error)
    call append_text('lines.txt', 'two'//nl, error)
    call read_lines('lines.txt', lines, error)
    call t%equal(size(lines), 2, 'a line is appended')
    call replace_file('lines.txt', 'three'//nl, error)
    call read_lines('lines.txt', lines, error)
    call t%equal(size(lines), 1, 'a file is replaced')
    call t%check(.not. file_exists('lines.txt.part'), 'no part stays')
    if (file_exists('/dev/full')) then
      call append_text('/dev/full', 'x', error)
      call t%check(allocated(error), 'a full disk is an error')
      call t%equal(error%code, exit_output, 'with its exit code')
    end if
    call remove_file('copy.txt')
    call create_text('copy.txt', 'three'//nl, error)
    call t%check(.not. allocated(error), 'a file is created')
    call overwrite_text('copy.txt', 4_i8, 'ead'//nl//'four'//nl, error)
    call read_lines('copy.txt', lines, error)
    call t%check(lines(1)%s == 'thread' .and. lines(2)%s == 'four', 'and written over from a place on')
    call create_text('copy.txt', 'x', error)
    call t%check(allocated(error), 'a file that exists is not created')
    call remove_file('copy.txt')
    ! A link under the name that a file has while it is written is not followed.
    call execute_command_line('ln -sf lines.txt linked.txt.part')
    call replace_file('linked.txt', 'x', error)
    call read_lines('lines.txt', lines, error)
    call t%check(lines(1)%s == 'three' .and. .not. is_link('linked.txt'), 'a link is replaced')
    call replace_file('no_such_folder/lines.txt', 'x', error)
    call t%check(allocated(error), 'a missing folder is an error')
  end subroutine test_text_files

  !> Measures whose values are their places.
  function numbered(dimension, has_bonds) result(measures)
    integer, intent(in) :: dimension
    logical, intent(in) :: has_bonds
    type(measures_t) :: measures
    integer :: i

    measures = unmeasured(dimension, has_bonds)
    do i = 1, size(measures%column)
      measures%column(i)%value = real(i, wp)
    end do
  end function numbered

  !> A record with rows of steps 1 to `n`.
  subroutine write_record(record, n)
    type(record_t), intent(inout) :: record
    integer, intent(in) :: n
    type(error_t), allocatable :: error
    type(report_t) :: report
    type(totals_t) :: totals
    type(measures_t) :: measures
    integer :: i

    call record%start('record.csv', unmeasured(2, .false.), error)
    call t%check(.not. allocated(error), 'a record starts')
    do i = 1, n
      report%is_converged = modulo(i, 2) == 0
      measures = numbered(2, .false.)
      if (i == 3) measures%column(1)%value = nan()
      call record%add(record_columns(i, real(i, wp)/10, 12, report, totals, measures), error)
    end do
  end subroutine write_record

  subroutine test_rows()
    type(record_t) :: record
    type(error_t), allocatable :: error
    type(text_t), allocatable :: lines(:)

    call write_record(record, 3)
    call read_lines('record.csv', lines, error)
    call t%equal(size(lines), 4, 'a header and three rows')
    call t%check(index(lines(1)%s//',', promised_columns()//',') == 1, 'the columns promised')
    call t%equal(commas(lines(2)%s), commas(lines(1)%s), 'a cell a column')
    call t%check(lines(2)%s(:2) == '1,', 'the step comes first')
    call t%check(index(lines(2)%s, ',0,0.0000') > 0 .and. index(lines(3)%s, ',1,0.0000') > 0, 'converged is 0 or 1')
    call t%check(index(lines(2)%s, ',14,15,16,') > 0, 'counts are whole numbers: '//lines(2)%s)
    call t%check(index(lines(4)%s, ',nan,') > 0, 'a number that is none')
  end subroutine test_rows

  !> In space a row has cells for nine stresses, three momenta and pairs by four points; a record of the plane does not fit.
  subroutine test_rows_in_space()
    type(record_t) :: record
    type(error_t), allocatable :: error
    type(report_t) :: report
    type(totals_t) :: totals
    type(measures_t) :: measures
    type(text_t), allocatable :: lines(:)

    call record%start('space.csv', unmeasured(3, .false.), error)
    measures = numbered(3, .false.)
    call record%add(record_columns(1, 0.1_wp, 12, report, totals, measures), error)
    call record%add(record_columns(2, 0.2_wp, 12, report, totals, measures), error)
    call read_lines('space.csv', lines, error)
    call t%equal(size(lines), 3, 'a header and two rows in space')
    call t%check(index(lines(1)%s//',', promised_columns()//',') == 1, 'the columns promised stand in space, too')
    call t%check(index(lines(1)%s, ',rattlers,quadruple_contacts,stress_xx,stress_xy,stress_xz,stress_yx,') > 0, 'more follow')
    call t%check(index(lines(1)%s, ',stress_zz,shear_rate,momentum_x,momentum_y,momentum_z,fabric_xx,') > 0, 'and more')
    call t%equal(commas(lines(2)%s), commas(lines(1)%s), 'a cell a column in space')
    call t%check(index(lines(2)%s, ',22,23,2.4') > 0, 'counts are whole numbers in space: '//lines(2)%s)
    call record%resume('space.csv', unmeasured(3, .false.), 1, error)
    call t%check(.not. allocated(error), 'a record in space goes on')
    call read_lines('space.csv', lines, error)
    call t%equal(size(lines), 2, 'later rows are cut in space')
    call record%resume('space.csv', unmeasured(2, .false.), 1, error)
    call t%check(allocated(error), 'a record in space is none of a scene in the plane')
    call test_bond_columns()
  end subroutine test_rows_in_space

  !> Columns of bonds stand where there are cohesive zones alone, at the end of the measures; records with and without do not mix.
  subroutine test_bond_columns()
    type(record_t) :: record
    type(error_t), allocatable :: error
    type(measures_t) :: measures
    type(report_t) :: report
    type(totals_t) :: totals
    type(text_t), allocatable :: lines(:)
    integer :: dimension, n

    do dimension = 2, 3
      measures = numbered(dimension, .true.)
      n = size(measures%column)
      call t%near(measures%get('damaged_bonds'), real(n, wp), 0.0_wp, 'a measure of bonds by its name')
      call t%near(measures%get('wall_coordination'), real(n - 4, wp), 0.0_wp, 'one before them')
      call record%start('bonds.csv', unmeasured(dimension, .true.), error)
      call record%add(record_columns(1, 0.1_wp, 12, report, totals, measures), error)
      call record%resume('bonds.csv', unmeasured(dimension, .true.), 1, error)
      call t%check(.not. allocated(error), 'a record with bonds goes on')
      call read_lines('bonds.csv', lines, error)
      call t%check(index(lines(1)%s, ',bond_energy,bond_loss,bonds,damaged_bonds,wall_predict,') > 0, 'columns of bonds')
      call t%check(index(lines(2)%s, ','//to_text(n - 1)//','//to_text(n)//',') > 0, 'bonds are counted')
      call record%resume('bonds.csv', unmeasured(dimension, .false.), 1, error)
      call t%check(allocated(error), 'a record with bonds is none of a scene without')
      call record%start('bonds.csv', unmeasured(dimension, .false.), error)
      call read_lines('bonds.csv', lines, error)
      call t%equal(index(lines(1)%s, 'bond'), 0, 'no columns of bonds in other scenes')
      call record%resume('bonds.csv', unmeasured(dimension, .true.), 1, error)
      call t%check(allocated(error), 'and the other way round')
    end do
  end subroutine test_bond_columns

  subroutine test_restart()
    type(record_t) :: record
    type(error_t), allocatable :: error
    type(text_t), allocatable :: lines(:)

    call write_record(record, 5)
    call append_text('record.csv', '2,torn', error)
    call record%resume('record.csv', unmeasured(2, .false.), 3, error)
    call t%check(.not. allocated(error), 'a record goes on')
    call read_lines('record.csv', lines, error)
    call t%equal(size(lines), 4, 'later and torn rows are cut')
    call t%check(lines(4)%s(:2) == '3,', 'the last row is that of the checkpoint')
    call replace_file('record.csv', 'step,other'//nl, error)
    call record%resume('record.csv', unmeasured(2, .false.), 3, error)
    call t%check(allocated(error), 'other columns are an error')
    call remove_file('record.csv')
    call record%resume('record.csv', unmeasured(2, .false.), 3, error)
    call t%check(.not. allocated(error), 'a missing record is no error')
    call t%check(file_exists('record.csv'), 'a missing record is begun')
  end subroutine test_restart

  !> A record on a device that is always full.
  subroutine test_full_disk()
    type(record_t) :: record
    type(error_t), allocatable :: error
    type(report_t) :: report
    type(totals_t) :: totals
    type(measures_t) :: measures
    integer :: status

    if (.not. file_exists('/dev/full')) then
      write (*, '(a)') 'skipped: no /dev/full'
      return
    end if
    call record%start('full.csv', unmeasured(2, .false.), error)
    measures = unmeasured(2, .false.)
    call remove_file('full.csv')
    call execute_command_line('ln -s /dev/full full.csv', exitstat=status)
    call record%add(record_columns(1, 0.1_wp, 12, report, totals, measures), error)
    call remove_file('full.csv')
    call t%check(allocated(error), 'a full disk is noticed')
    if (allocated(error)) call t%equal(error%code, exit_output, 'and has its exit code')
  end subroutine test_full_disk

  !> run.json of a scene in space, and of one that ended before it was measured.
  subroutine test_summary_in_space()
    type(run_summary_t) :: summary
    type(scene_t) :: scene
    type(run_options_t) :: options
    type(measures_t) :: measures
    type(totals_t) :: totals
    type(comm_t) :: alone
    type(error_t), allocatable :: error

    scene%dimension = 3
    call scene%bodies%allocate(2, 3)
    scene%bodies%area = 4*pi/3*[1.0_wp, 27.0_wp]
    call summary%describe(scene, options, 'deck.toml', alone)
    totals%worst_penetration = 0.25_wp
    call summary%conclude(run_done, '', 0.5_wp, totals, measures)
    call write_run_summary(summary, 'space.json', error)
    call t%check(python_agrees('space.json', 'run[''momentum_z''] == 0 and run[''quadruple_contacts''] == 0'), 'nothing measured')
    measures = numbered(3, .false.)
    call summary%conclude(run_done, '', 0.5_wp, totals, measures)
    call write_run_summary(summary, 'space.json', error)
    call t%check(python_agrees('space.json', 'run[''dimension''] == 3 and run[''momentum_z''] == 36 and '// &
      'run[''stress_xx''] == 24 and run[''stress_zz''] == 32 and run[''stress_zy''] == 31 '// &
      'and run[''quadruple_contacts''] == 23 and run[''worst_penetration''] == 0.25 and abs(run[''mean_radius''] - 2) < 1e-14'), &
                 'a run in space')
    call write_numbers(summary, 'space.tag', error)
    call t%check(.not. allocated(error), 'tagged numbers are written')
    call t%equal(count_lines_with('space.tag', 'stress_'), 9, 'nine stresses are tagged')
  end subroutine test_summary_in_space

  !> Lines of a file that hold a word.
  integer function count_lines_with(file, word) result(n)
    character(len=*), intent(in) :: file, word
    type(text_t), allocatable :: lines(:)
    type(error_t), allocatable :: error
    integer :: i

    call read_lines(file, lines, error)
    n = count([(index(lines(i)%s, word) > 0, i=1, size(lines))])
  end function count_lines_with

  !> A concluded run of one grain.
  function concluded() result(summary)
    type(run_summary_t) :: summary
    type(scene_t) :: scene
    type(run_options_t) :: options
    type(totals_t) :: totals
    type(measures_t) :: measures
    type(comm_t) :: alone
    type(report_t) :: report

    call scene%bodies%allocate(1)
    scene%bodies%area = 3
    options%steps = 1
    options%folder = 'results'
    options%deck_hash = 'abc'
    report%sweeps = 20
    call totals%add(report, 7)
    call totals%clock%start()
    call totals%tick()
    measures = unmeasured(2, .false.)
    measures%column(3)%value = nan()
    call summary%describe(scene, options, 'decks/odd "name".toml', alone)
    call summary%add_file('record', 'record.csv')
    call summary%conclude(run_done, '', 0.5_wp, totals, measures)
  end function concluded

  subroutine test_summary()
    type(run_summary_t) :: summary
    type(error_t), allocatable :: error
    type(text_t), allocatable :: lines(:)
    integer :: i

    call write_run_summary(summary, 'run.json', error)
    call t%check(python_agrees('run.json', 'run[''status''] == ''failed'''), 'a run of which nothing is known failed')
    summary = concluded()
    call write_run_summary(summary, 'run.json', error)
    call t%check(.not. allocated(error), 'run.json is written')
    call read_lines('run.json', lines, error)
    call t%check(lines(1)%s == '{' .and. lines(size(lines))%s == '}', 'one object')
    do i = 2, size(lines) - 1
      call t%check(lines(i)%s(:3) == '  "' .and. index(lines(i)%s, '": ') > 0, 'a member: '//lines(i)%s)
      call t%check((lines(i)%s(len(lines(i)%s):) == ',') .eqv. (i < size(lines) - 1), 'commas between members')
    end do
    call t%check(python_agrees('run.json', 'run[''status''] == ''done'' and run[''steps''] == 1 and run[''contacts''] == 7 '// &
      'and run[''external_work''] is None and run[''file_record''] == ''record.csv'' and run[''grains''] == 1 '// &
      'and run[''peak_memory_bytes''] > 0 and run[''time''] == 0.5 and run[''deck_hash''] == ''abc'' '// &
      'and not any(isinstance(v, (list, dict)) for v in run.values())'), 'another reader agrees')
  end subroutine test_summary

  subroutine test_verdict()
    type(error_t), allocatable :: error
    type(text_t), allocatable :: lines(:)
    integer :: unit

    open (newunit=unit, file='verdict.txt', status='replace', action='write')
    call print_verdict(unit, concluded())
    close (unit)
    call read_lines('verdict.txt', lines, error)
    call t%equal(size(lines), 11, 'a verdict of eleven lines')
    call t%check(index(lines(1)%s, 'done: 1 of 1 steps') == 1, 'how it ended: '//lines(1)%s)
    call t%check(index(lines(11)%s, 'record.csv in results') > 0, 'what to open: '//lines(11)%s)
    call test_advice()
  end subroutine test_verdict

  !> What is advised where steps did not converge: nothing that scenes with cohesive zones do not obey.
  subroutine test_advice()
    type(run_summary_t) :: summary
    type(report_t) :: report
    type(error_t), allocatable :: error
    type(text_t), allocatable :: lines(:)
    integer :: unit, i, j
    logical :: has_auto, has_step

    summary = concluded()
    report%is_converged = .false.
    call summary%totals%add(report, 7)
    call summary%totals%note_unconverged(2, [3, 4], 0.5_wp)
    do i = 0, 1
      summary%has_bonds = i == 1
      open (newunit=unit, file='advice.txt', status='replace', action='write')
      call print_verdict(unit, summary)
      close (unit)
      call read_lines('advice.txt', lines, error)
      has_auto = .false.
      has_step = .false.
      do j = 1, size(lines)
        if (index(lines(j)%s, '  try ') /= 1) cycle
        has_auto = index(lines(j)%s, 'solver.method') > 0
        has_step = index(lines(j)%s, 'a shorter time.step where the damage of bonds does not settle') > 0
      end do
      call t%check(has_auto .neqv. summary%has_bonds, 'another method is advised where there is one')
      call t%check(has_step .eqv. summary%has_bonds, 'a shorter step is advised where bonds may snap')
    end do
  end subroutine test_advice

  subroutine test_progress()
    type(progress_t) :: progress
    type(report_t) :: report
    type(error_t), allocatable :: error
    type(text_t), allocatable :: lines(:)
    integer :: unit

    report%sweeps = 30
    report%is_converged = .false.
    report%worst_speed = 2
    open (newunit=unit, file='progress.txt', status='replace', action='write')
    call progress%start(unit, 100, 200, 'e8', .false., .false., is_stage=.true.)
    call t%check(.not. progress%is_due(), 'no line at once')
    call progress%show(150, 0.25_wp, 12, report, 1.5_wp)
    call progress%finish()
    call progress%start(unit, 100, 200, 'e8', .true., .false., is_stage=.true.)
    call progress%show(150, 0.25_wp, 12, report, 1.5_wp)
    call progress%show(200, 0.5_wp, 12, report, 1.5_wp)
    call progress%finish()
    call progress%start(unit, 100, 200, 'e8', .true., .true.)
    call progress%show(200, 0.5_wp, 12, report, 1.5_wp)
    close (unit)
    call read_lines('progress.txt', lines, error)
    call t%equal(size(lines), 2, 'one line in batch, one bar redrawn, nothing when quiet')
    call t%check(index(lines(1)%s, 'step 150 of 200, time 2.500E-01 s, 12 contacts, 30 sweeps, e8') == 1, 'batch: '//lines(1)%s)
    call t%check(index(lines(2)%s, achar(13)//'[==========          ]  50%') == 1, 'half a bar: '//lines(2)%s)
    call t%check(index(lines(2)%s, achar(13)//'[====================] 100%') > 1, 'a full bar')
    call t%check(duration_text(3725.0_wp) == '1:02:05' .and. duration_text(59.6_wp) == '1:00', 'durations')
    call t%check(index(lines(1)%s, 'e8 0.0E+00! (a contact breaks its law by 2.0E+00 m/s), kinetic') > 0, 'why: '//lines(1)%s)
    call t%check(index(lines(1)%s, ' left of the stage') == len(lines(1)%s) - 17, 'what is left of a stage: '//lines(1)%s)
    call t%check(index(lines(2)%s, ' left') > 0 .and. index(lines(2)%s, 'stage') == 0, 'no stage in a bar, which has little room')
  end subroutine test_progress

  !> Seconds per step of late. Steps that all cost the same: their cost. Steps whose cost grows as their number (0.2 ms times n, so
  !! that n steps take 1e-4 n^2 s, as a bed that is poured): the mean since the start is half the cost of the present step; that
  !! of a tenth of the time, of steps of cost c(t) ~ sqrt(t), is below it by about a twentieth. One step in a hundred that costs
  !! a hundred times as much, shown alone: no more than a step in a hundred. Steps ten times dearer from some time on: within 1 %
  !! after ten times the memory.
  subroutine test_recent_steps()
    real(wp) :: recent(2), elapsed
    integer :: n

    recent = 0
    call add_recent([5.0_wp, 50.0_wp], 5.0_wp, recent)
    call t%near(recent(1)/recent(2), 0.1_wp, 1e-15_wp, 'the first steps')
    call add_recent([5.0_wp, 50.0_wp], 10.0_wp, recent)
    call t%near(recent(1)/recent(2), 0.1_wp, 1e-15_wp, 'steps of one cost')
    recent = 0
    do n = 50, 5000, 50
      call add_recent([1e-4_wp*(real(n, wp)**2 - real(n - 50, wp)**2), 50.0_wp], 1e-4_wp*real(n, wp)**2, recent)
    end do
    call t%check(recent(1)/recent(2) > 0.9_wp*1.0_wp .and. recent(1)/recent(2) < 1, 'steps that grow dearer')
    recent = [9.9_wp, 99.0_wp]
    call add_recent([10.0_wp, 1.0_wp], 1000.0_wp, recent)
    call t%near(recent(1)/recent(2), 19.9_wp/100, 0.02_wp, 'one dear step counts as one')
    recent = [10.0_wp, 100.0_wp]
    elapsed = 100
    do n = 1, 600
      elapsed = elapsed + 1
      call add_recent([1.0_wp, 1.0_wp], elapsed, recent)
    end do
    call t%near(recent(1)/recent(2), 1.0_wp, 0.01_wp, 'dearer from some time on')
  end subroutine test_recent_steps
end program test_record
