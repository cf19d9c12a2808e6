!> Tests. Circuits and branches of six-bars of Watt's second and Stephenson's third kind, driven at the crank, from their
!> dyads alone: at each crank angle each of two dyads can be assembled in two ways, or not at all. A branch is an
!> interval of the crank angle with one choice for each; where a dyad is in line its two choices meet.
module dyad_circuits
   use kinds, only: wp
   use plane_vectors, only: pi
   implicit none
   private
   public :: six_bar_t, branches_t, find_branches, positions, is_assembled

   !> Angles at which dyads are looked at; their limits are bracketed between these.
   integer, parameter :: samples = 2880

   !> Crank, coupler, rocker and base; an arm of the length `arm` at the angle `direction` from the rocker (`watt`) or the
   !> coupler; rod and output, which turns about `pivot`.
   type :: six_bar_t
      logical :: watt = .true.
      real(wp) :: crank = 1.0_wp, coupler = 1.0_wp, rocker = 1.0_wp, base = 1.0_wp
      real(wp) :: arm = 1.0_wp, direction = 0.0_wp, rod = 1.0_wp, output = 1.0_wp, pivot(2) = 0.0_wp
   end type six_bar_t

   !> Branches, and to which circuit each belongs.
   type :: branches_t
      real(wp), allocatable :: range(:, :)     !< (2, branches) of the crank angle; a turn: it turns fully
      integer, allocatable :: circuit(:)       !< (branches)
   end type branches_t

contains

   !> All branches of `m`.
   function find_branches(m) result(all_of_them)
      type(six_bar_t), intent(in) :: m
      type(branches_t) :: all_of_them
      real(wp), allocatable :: ends(:, :)
      integer, allocatable :: kinds_of(:, :), choice(:)
      real(wp) :: from, to
      integer :: s, k, n, i, j, side, old

      allocate (ends(2, 0), kinds_of(2, 0), choice(0))
      do s = 1, 2
         if (all([(margin(m, angle(k), s) >= 0.0_wp, k=1, samples)])) then
            ends = reshape([ends, 0.0_wp, 2.0_wp*pi], [2, size(ends, 2) + 1])
            kinds_of = reshape([kinds_of, 0, 0], [2, size(ends, 2)])
            choice = [choice, s]
            cycle
         end if
         do k = 1, samples
            if (margin(m, angle(k - 1), s) >= 0.0_wp .or. margin(m, angle(k), s) < 0.0_wp) cycle
            from = limit(m, angle(k - 1), angle(k), s)
            n = k
            do while (margin(m, angle(n + 1), s) >= 0.0_wp)
               n = n + 1
            end do
            to = limit(m, angle(n + 1), angle(n), s)
            ends = reshape([ends, from, to], [2, size(ends, 2) + 1])
            kinds_of = reshape([kinds_of, kind_of(m, from, s), kind_of(m, to, s)], [2, size(ends, 2)])
            choice = [choice, s]
         end do
      end do
      n = size(choice)
      ! Branch k has the first choice of the second dyad, branch n + k the other one.
      all_of_them%range = reshape([ends, ends], [2, 2*n])
      all_of_them%circuit = [(k, k=1, 2*n)]
      do k = 1, n
         do side = 1, 2
            if (kinds_of(side, k) == 2) call join(k, n + k)
            if (kinds_of(side, k) /= 1) cycle
            do i = 1, n
               if (choice(i) == choice(k) .or. kinds_of(side, i) /= 1) cycle
               if (abs(modulo(ends(side, i) - ends(side, k) + pi, 2.0_wp*pi) - pi) > 1.0e-9_wp) cycle
               do j = 0, n, n
                  call join(j + k, j + i)
               end do
            end do
         end do
      end do

   contains

      !> Both branches are of one circuit.
      subroutine join(a, b)
         integer, intent(in) :: a, b

         old = all_of_them%circuit(b)
         where (all_of_them%circuit == old) all_of_them%circuit = all_of_them%circuit(a)
      end subroutine join
   end function find_branches

   !> Angle number `k`.
   pure real(wp) function angle(k)
      integer, intent(in) :: k

      angle = 2.0_wp*pi*(real(k, wp) + 0.1_wp)/real(samples, wp)
   end function angle

   !> The angle between `outside` and `inside` at which the assembly ends.
   pure real(wp) function limit(m, outside, inside, s)
      type(six_bar_t), intent(in) :: m
      real(wp), intent(in) :: outside, inside
      integer, intent(in) :: s
      real(wp) :: a, b
      integer :: i

      a = outside
      b = inside
      do i = 1, digits(1.0_wp) + 4
         limit = 0.5_wp*(a + b)
         if (margin(m, limit, s) >= 0.0_wp) then
            b = limit
         else
            a = limit
         end if
      end do
   end function limit

   !> Which dyad is in line at `phi`, that the assembly ends there.
   pure integer function kind_of(m, phi, s)
      type(six_bar_t), intent(in) :: m
      real(wp), intent(in) :: phi
      integer, intent(in) :: s
      real(wp) :: p(2, 4), both(2)

      call positions(m, phi, s, 1, p, both)
      kind_of = merge(1, 2, abs(both(1)) < abs(both(2)))
   end function kind_of

   !> By how much both dyads are from where they cannot be assembled: below 0 where one cannot.
   pure real(wp) function margin(m, phi, s)
      type(six_bar_t), intent(in) :: m
      real(wp), intent(in) :: phi
      integer, intent(in) :: s
      real(wp) :: p(2, 4), both(2)

      call positions(m, phi, s, 1, p, both)
      margin = minval(both)
   end function margin

   !> Whether `m` can be assembled at `phi` with the choice `s` of its first dyad.
   pure logical function is_assembled(m, phi, s)
      type(six_bar_t), intent(in) :: m
      real(wp), intent(in) :: phi
      integer, intent(in) :: s

      is_assembled = margin(m, phi, s) > 0.0_wp
   end function is_assembled

   !> The joints `p` (2, 4): of crank and coupler, coupler and rocker, arm and rod, rod and output; for the choices `s1`
   !> and `s2`, and by how much each dyad is from its limits (2).
   pure subroutine positions(m, phi, s1, s2, p, both)
      type(six_bar_t), intent(in) :: m
      real(wp), intent(in) :: phi
      integer, intent(in) :: s1, s2
      real(wp), intent(out) :: p(2, 4), both(2)
      real(wp) :: e(2)

      p = 0.0_wp
      both(2) = huge(1.0_wp)
      p(:, 1) = m%crank*[cos(phi), sin(phi)]
      call meet(p(:, 1), m%coupler, [m%base, 0.0_wp], m%rocker, s1, p(:, 2), both(1))
      if (both(1) < 0.0_wp) return
      if (m%watt) then
         e = (p(:, 2) - [m%base, 0.0_wp])/m%rocker
         p(:, 3) = [m%base, 0.0_wp]
      else
         e = (p(:, 2) - p(:, 1))/m%coupler
         p(:, 3) = p(:, 1)
      end if
      p(:, 3) = p(:, 3) + m%arm*[e(1)*cos(m%direction) - e(2)*sin(m%direction), &
         e(2)*cos(m%direction) + e(1)*sin(m%direction)]
      call meet(p(:, 3), m%rod, m%pivot, m%output, s2, p(:, 4), both(2))
   end subroutine positions

   !> The place `c` at the distances `ra` from `a` and `rb` from `b`, on the left of the way from a to b for `s` = 1;
   !> `room`: how far from where there is none.
   pure subroutine meet(a, ra, b, rb, s, c, room)
      real(wp), intent(in) :: a(2), ra, b(2), rb
      integer, intent(in) :: s
      real(wp), intent(out) :: c(2), room
      real(wp) :: d, x, e(2)

      d = norm2(b - a)
      room = min(ra + rb - d, d - abs(ra - rb))
      e = (b - a)/d
      x = (d**2 + ra**2 - rb**2)/(2.0_wp*d)
      c = a + x*e + merge(1.0_wp, -1.0_wp, s == 1)*sqrt(max(0.0_wp, ra**2 - x**2))*[-e(2), e(1)]
   end subroutine meet
end module dyad_circuits
