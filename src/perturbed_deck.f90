!> Level 3. A mechanism as it would be if every number of its deck were a little off: what that changes in a result
!> is what the result does not know.
module perturbed_deck
   use, intrinsic :: iso_fortran_env, only: int64
   use kinds, only: wp
   use mechanism, only: mechanism_t, drive_t, pair_prismatic, term_table, term_harmonic
   implicit none
   private
   public :: perturbed, perturbed_instant, perturbation, sample_count

   !> Relative; many roundings, so that those of the calculation itself are small beside it, and so little that the
   !> change stays in proportion at 1E-12 from a dead point.
   real(wp), parameter :: perturbation = 256.0_wp*epsilon(1.0_wp)
   !> Of eight numbers by chance the largest is seldom a small one.
   integer, parameter :: sample_count = 8
   !> Signs by chance, the same ones everywhere (Park and Miller's generator).
   integer(int64), parameter :: multiplier = 16807_int64, modulus = 2147483647_int64, seed = 1987_int64

contains

   !> `m` with every number up or down by `perturbation`, by chance as sample `k` = 1, 2, ... has it; 0: as it is.
   pure function perturbed(m, k) result(p)
      type(mechanism_t), intent(in) :: m
      integer, intent(in) :: k
      type(mechanism_t) :: p
      integer(int64) :: dice
      integer :: i

      p = m
      if (k == 0) return
      dice = seed*k
      do i = 1, size(p%links)
         if (p%links(i)%ground) call shift(p%links(i)%position, abs(p%links(i)%position), dice)
      end do
      do i = 1, size(p%points)
         ! Across as well: an arm is turned by an angle that is rounded.
         call shift(p%points(i)%offset, spread(norm2(p%points(i)%offset), 1, 2), dice)
      end do
      do i = 1, size(p%pairs)
         if (p%pairs(i)%kind == pair_prismatic) call shift_guide(p%pairs(i)%alpha, p%pairs(i)%offset, &
            p%pairs(i)%beta, dice)
      end do
      do i = 1, size(p%drives)
         call shift_drive(p%drives(i), dice)
      end do
   end function perturbed

   !> Instant `t` of sample `k`.
   pure real(wp) function perturbed_instant(t, k)
      real(wp), intent(in) :: t
      integer, intent(in) :: k

      perturbed_instant = t
      if (k > 0) perturbed_instant = t*(1.0_wp + merge(perturbation, -perturbation, mod(k, 2) == 1))
   end function perturbed_instant

   pure subroutine shift_guide(alpha, offset, beta, dice)
      real(wp), intent(inout) :: alpha, offset, beta
      integer(int64), intent(inout) :: dice
      real(wp) :: x(3)

      x = [alpha, offset, beta]
      call shift(x, [max(1.0_wp, abs(alpha)), abs(offset), abs(beta)], dice)
      alpha = x(1)
      offset = x(2)
      beta = x(3)
   end subroutine shift_guide

   pure subroutine shift_drive(drive, dice)
      type(drive_t), intent(inout) :: drive
      integer(int64), intent(inout) :: dice
      integer :: i

      call shift(drive%polynomial, abs(drive%polynomial), dice)
      if (.not. allocated(drive%terms)) return
      do i = 1, size(drive%terms)
         if (drive%terms(i)%kind == term_table) then
            call shift(drive%terms(i)%values, abs(drive%terms(i)%values), dice)
         else
            ! The second number of a power says what kind of function it is.
            call shift(drive%terms(i)%r(1:1), abs(drive%terms(i)%r(1:1)), dice)
            if (drive%terms(i)%kind == term_harmonic) &
               call shift(drive%terms(i)%r(2:3), abs(drive%terms(i)%r(2:3)), dice)
         end if
      end do
   end subroutine shift_drive

   !> Each of `x` up or down by `perturbation` times its `size_of`.
   pure subroutine shift(x, size_of, dice)
      real(wp), intent(inout) :: x(:)
      real(wp), intent(in) :: size_of(:)
      integer(int64), intent(inout) :: dice
      integer :: i

      do i = 1, size(x)
         dice = mod(multiplier*dice, modulus)
         x(i) = x(i) + merge(perturbation, -perturbation, 2*dice > modulus)*size_of(i)
      end do
   end subroutine shift
end module perturbed_deck
