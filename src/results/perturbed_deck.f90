!> A mechanism as it would be if every number of its deck were a little off: what that changes in a result
!> is what the result does not know.
module perturbed_deck
   use, intrinsic :: iso_fortran_env, only: int64
   use kinds, only: wp
   use blocks, only: blocks_t
   use mechanism, only: mechanism_t, drive_t, plane_origin, pair_prismatic, term_power, term_table, drive_relangle
   implicit none
   private
   public :: perturbed, perturbed_instant, perturbation, sample_count, all_samples, round_loops, &
      largest_place

   !> Relative; many roundings, so that those of the calculation itself are small beside it, and so little that
   !> 2.3E-12 from a dead point the change is at most 1.6 times that in proportion.
   real(wp), parameter :: perturbation = 256.0_wp*epsilon(1.0_wp)
   !> Of eight numbers by chance the largest is seldom a small one.
   integer, parameter :: sample_count = 8
   !> With these few more no two numbers are off by as much. A body vector is the difference of two points, and right
   !> in every sample that moves both by as much the same way: in one of sixteen mechanisms in all of the others.
   integer, parameter :: all_samples = 12
   !> Signs by chance, the same ones everywhere (Park and Miller's generator).
   integer(int64), parameter :: multiplier = 16807_int64, modulus = 2147483647_int64, seed = 198709_int64

   !> Numbers that are the same on many cards have the same rounding, and a sum of many is rounded the same way again
   !> and again: in every second sample all cards of a kind are off alike.
   type :: dice_t
      integer(int64) :: first = seed, last = seed
      logical :: alike = .false.
      real(wp) :: least = 1.0_wp, most = 1.0_wp   !< parts of the perturbation
   end type dice_t

contains

   !> `m` with every number up or down by `perturbation`, by chance as sample `k` = 1, 2, ... has it; 0: as it is.
   pure function perturbed(m, k) result(p)
      type(mechanism_t), intent(in) :: m
      integer, intent(in) :: k
      type(mechanism_t) :: p
      type(dice_t) :: dice
      real(wp) :: origin(2)
      integer :: i

      p = m
      if (k == 0) return
      if (k > sample_count) then
         dice = dice_t(seed*k, seed*k, least=0.4_wp, most=1.2_wp)
      else
         dice = dice_t(seed*k, seed*k, alike=mod(k, 2) == 0)
      end if
      do i = 1, size(p%links)
         if (.not. p%links(i)%ground) cycle
         call take(1, dice)
         call shift(p%links(i)%position, abs(p%links(i)%position), dice)
      end do
      origin = plane_origin(m)
      do i = 1, size(p%points)
         call take(2, dice)
         ! Across as well: an arm is turned by an angle that is rounded.
         call shift(p%points(i)%offset, spread(size_of_place(m, i, origin), 1, 2), dice)
      end do
      do i = 1, size(p%pairs)
         if (p%pairs(i)%kind /= pair_prismatic) cycle
         call take(3, dice)
         call shift_guide(p%pairs(i)%alpha, p%pairs(i)%offset, p%pairs(i)%beta, dice)
      end do
      do i = 1, size(p%drives)
         call take(4, dice)
         call shift_drive(p%drives(i), dice)
      end do
   end function perturbed

   !> Instant `t` of sample `k`; off by a rounding alone where `k` is negative.
   pure real(wp) function perturbed_instant(t, k)
      real(wp), intent(in) :: t
      integer, intent(in) :: k
      real(wp) :: part

      perturbed_instant = t
      if (k == 0) return
      part = merge(perturbation, epsilon(1.0_wp), k > 0)
      perturbed_instant = t*(1.0_wp + merge(part, -part, mod(abs(k)/2, 2) == 1))
   end function perturbed_instant

   !> The size of the largest number that the place of point number `i` is a sum of: a ground link's is counted from
   !> `origin`.
   pure real(wp) function size_of_place(m, i, origin) result(size_of)
      type(mechanism_t), intent(in) :: m
      integer, intent(in) :: i
      real(wp), intent(in) :: origin(2)

      associate (link => m%links(m%points(i)%link))
         size_of = norm2(m%points(i)%offset)
         if (link%ground) size_of = max(size_of, norm2(link%position(:2) - origin))
      end associate
   end function size_of_place

   !> Moves each vector of the loops of `b` up or down by a rounding, by chance as sample `k` < 0 has it.
   !> The part of a loop that the ground gives is the difference of two places on it, and rounded as these are: `place`
   !> is the largest, in solver lengths.
   pure subroutine round_loops(b, k, place)
      type(blocks_t), intent(inout) :: b
      integer, intent(in) :: k
      real(wp), intent(in) :: place
      type(dice_t) :: dice
      real(wp) :: v(2)
      integer :: i

      dice = dice_t(-seed*k, -seed*k)
      do i = 1, size(b%body_vectors)
         v = [b%body_vectors(i)%x, b%body_vectors(i)%y]
         call round_vector(v, norm2(v), dice)
         b%body_vectors(i)%x = v(1)
         b%body_vectors(i)%y = v(2)
      end do
      do i = 1, size(b%slides)
         call round_vector(b%slides(i)%body_vector, norm2(b%slides(i)%body_vector), dice)
      end do
      do i = 1, size(b%loops)
         associate (g => b%loops(i))
            if (any(abs(g%ground) > 0.0_wp)) call round_vector(g%ground, max(norm2(g%ground), place/g%unit), dice)
         end associate
      end do
   end subroutine round_loops

   !> Moves `v` by a rounding of `size_of`, along and across.
   pure subroutine round_vector(v, size_of, dice)
      real(wp), intent(inout) :: v(2)
      real(wp), intent(in) :: size_of
      type(dice_t), intent(inout) :: dice

      call shift(v, spread(size_of*epsilon(1.0_wp)/perturbation, 1, 2), dice)
   end subroutine round_vector

   !> The largest number, in the deck's unit, that the place of a point of the ground is a sum of.
   pure real(wp) function largest_place(m) result(largest)
      type(mechanism_t), intent(in) :: m
      real(wp) :: origin(2)
      integer :: i

      origin = plane_origin(m)
      largest = 0.0_wp
      do i = 1, size(m%points)
         if (m%links(m%points(i)%link)%ground) largest = max(largest, size_of_place(m, i, origin))
      end do
   end function largest_place

   !> Perturbs a prismatic pair's guide: alpha and beta (rad), offset (length).
   pure subroutine shift_guide(alpha, offset, beta, dice)
      real(wp), intent(inout) :: alpha, offset, beta
      type(dice_t), intent(inout) :: dice
      real(wp) :: x(3)

      x = [alpha, offset, beta]
      call shift(x, [max(1.0_wp, abs(alpha)), abs(offset), abs(beta)], dice)
      alpha = x(1)
      offset = x(2)
      beta = x(3)
   end subroutine shift_guide

   !> Perturbs the numbers of a drive's law.
   pure subroutine shift_drive(drive, dice)
      type(drive_t), intent(inout) :: drive
      type(dice_t), intent(inout) :: dice
      real(wp) :: sizes(3)
      integer :: i

      sizes = abs(drive%polynomial)
      ! An angle counted from another link is added to that link's, and rounded with it.
      if (drive%kind == drive_relangle) sizes(1) = max(sizes(1), 1.0_wp)
      call shift(drive%polynomial, sizes, dice)
      if (.not. allocated(drive%terms)) return
      do i = 1, size(drive%terms)
         select case (drive%terms(i)%kind)
         case (term_table)
            call shift(drive%terms(i)%values, abs(drive%terms(i)%values), dice)
         case (term_power)
            ! The second number of a power says what kind of function it is.
            call shift(drive%terms(i)%r(1:1), abs(drive%terms(i)%r(1:1)), dice)
         case default
            call shift(drive%terms(i)%r, abs(drive%terms(i)%r), dice)
         end select
      end do
   end subroutine shift_drive

   !> Each of `x` up or down by its `size_of` times a part of the perturbation.
   pure subroutine shift(x, size_of, dice)
      real(wp), intent(inout) :: x(:)
      real(wp), intent(in) :: size_of(:)
      type(dice_t), intent(inout) :: dice
      real(wp) :: chance
      integer :: i

      do i = 1, size(x)
         dice%last = mod(multiplier*dice%last, modulus)
         chance = real(2*dice%last - modulus, wp)/real(modulus, wp)
         x(i) = x(i) + sign(dice%least + (dice%most - dice%least)*abs(chance), chance)*perturbation*size_of(i)
      end do
   end subroutine shift

   !> To be called for each card, of kind number `kind`.
   pure subroutine take(kind, dice)
      integer, intent(in) :: kind
      type(dice_t), intent(inout) :: dice

      if (dice%alike) dice%last = mod(multiplier*(dice%first + seed*kind), modulus)
   end subroutine take
end module perturbed_deck
