!> What shapes of a body share, against closed forms.
program test_shared_moments
  use harness, only: tests_t
  use sg_contactors, only: add_disk, contactors_t
  use sg_kinds, only: wp, pi
  use sg_shared_moments, only: shared_moments
  use sg_space_contactors, only: add_cylinder, add_sphere
  implicit none
  type(tests_t) :: t

  call test_disks()
  call test_spheres()
  call test_capsules()
  call t%finish()

contains

  !> A lens of two disks; three disks at one place; disks that share nothing.
  subroutine test_disks()
    type(contactors_t) :: pair, three, apart
    real(wp) :: volume, moment(3), second(3, 3)
    real(wp), parameter :: d = 1.4_wp
    integer :: i

    call add_disk(pair, 1, 1, 1.0_wp, [3.0_wp, 1.0_wp])
    call add_disk(pair, 1, 1, 1.0_wp, [3.0_wp + d, 1.0_wp])
    call shared_moments(pair, 1, 2, volume, moment, second)
    ! The lens is cut by lines of 5e-4: its tips, where chords are short, leave about the square of that.
    call t%near(volume, 2*acos(d/2) - d/2*sqrt(4 - d**2), 1e-5_wp, 'lens of two disks')
    call t%near(moment(1), volume*(3 + d/2), 1e-5_wp, 'its centre in x')
    call t%near(moment(2), volume, 1e-5_wp, 'its centre in y')
    do i = 1, 3
      call add_disk(three, 1, 1, 1.0_wp, [0.0_wp, 0.0_wp])
    end do
    call shared_moments(three, 1, 3, volume, moment, second)
    call t%near(volume, 2*pi, 1e-4_wp, 'three disks count two too often')
    call t%near(second(1, 1), 2*pi/4, 1e-4_wp, 'second moment along the lines')
    call t%near(second(2, 2), 2*pi/4, 1e-4_wp, 'second moment across the lines')
    call add_disk(apart, 1, 1, 1.0_wp, [0.0_wp, 0.0_wp])
    call add_disk(apart, 1, 1, 1.0_wp, [1.5_wp, 1.5_wp])
    call shared_moments(apart, 1, 2, volume, moment, second)
    call t%near(volume + sum(abs(moment)) + sum(abs(second)), 0.0_wp, 0.0_wp, 'disks apart share nothing')
  end subroutine test_disks

  !> A lens of two spheres at an angle to the lines.
  subroutine test_spheres()
    type(contactors_t) :: pair
    real(wp) :: volume, moment(3), second(3, 3), middle(3)
    real(wp), parameter :: d = 1.1_wp, apart(3) = d*[2.0_wp, -1.0_wp, 2.0_wp]/3

    pair%dimension = 3
    call add_sphere(pair, 1, 1, 1.0_wp, [0.0_wp, 0.0_wp, 0.0_wp])
    call add_sphere(pair, 1, 1, 1.0_wp, apart)
    call shared_moments(pair, 1, 2, volume, moment, second)
    ! Lines stand 0.006 apart, and the rim of the lens is cut to the power of 3/2 of that, here and there too much and too little.
    call t%near(volume, pi*(4 + d)*(2 - d)**2/12, 2e-4_wp, 'lens of two spheres')
    middle = moment/volume
    call t%near(maxval(abs(middle - apart/2)), 0.0_wp, 5e-4_wp, 'its centre')
  end subroutine test_spheres

  !> A capsule within a capsule, along the lines, across and aslant: all of the smaller one is shared.
  subroutine test_capsules()
    type(contactors_t) :: pair
    real(wp) :: volume, moment(3), second(3, 3), axis(3), expected
    integer :: i

    expected = pi*0.25_wp*2 + 4*pi/3*0.125_wp
    do i = 1, 4
      pair = contactors_t()
      pair%dimension = 3
      axis = 0
      axis(min(i, 3)) = 1
      if (i == 4) axis = [0.6_wp, 0.48_wp, 0.64_wp]
      call add_cylinder(pair, 1, 1, 2.0_wp, 1.0_wp, [0.0_wp, 0.0_wp, 0.0_wp], axis)
      call add_cylinder(pair, 1, 1, 1.0_wp, 0.5_wp, [0.0_wp, 0.0_wp, 0.0_wp], axis)
      call shared_moments(pair, 1, 2, volume, moment, second)
      call t%near(volume/expected, 1.0_wp, 2e-3_wp, 'a capsule in a capsule')
      call t%near(norm2(moment), 0.0_wp, 1e-3_wp, 'centre of both')
      ! About the axis: cylinder and ball, as of capsules.
      call t%near(second(1, 1) + second(2, 2) + second(3, 3) - dot_product(axis, matmul(second, axis)), &
                  pi*0.0625_wp + 0.4_wp*4*pi/3*0.03125_wp, 2e-3_wp, 'moment about the axis')
    end do
  end subroutine test_capsules
end program test_shared_moments
