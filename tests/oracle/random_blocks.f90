!> Tests. Blocks made by chance, to count their assemblies by another program:
!>
!>    random_blocks SEED deck     the deck, of 4, 6 or 8 links in one block without drives, with its ASSEMBLY card
!>    random_blocks SEED system   its closure equations as polynomials, in the form of PHCpack
!>
!> The equations are those of the pairs of the deck, in the places X = x + i y of the links and their directions w =
!> exp(i phi), and the conjugates of both: no tree, no loops, no slides. What is linear in (X, w) alone is eliminated.
program random_blocks
   use kinds, only: wp
   use plane_vectors, only: pi, rotated, direction
   use mechanism, only: mechanism_t, link_t, point_t, pair_t, request_t, pair_revolute, pair_prismatic
   use structure, only: structure_report_t, find_structure
   use bilinear, only: find_null_space
   use number_format, only: whole
   use dice, only: dice_t, new_dice, throw, chance, between
   use arguments, only: argument, number
   use printed_cards, only: card
   implicit none

   !> Of lengths in the system: so large that places are eliminated, and directions stay.
   real(wp), parameter :: unit = 16.0_wp
   type(mechanism_t) :: m
   type(dice_t) :: d

   d = new_dice(number(1))
   do
      call throw_mechanism(d, m)
      if (is_one_block(m)) exit
   end do
   if (argument(2) == 'system') then
      call print_system(m)
   else
      call print_deck(m)
   end if

contains

   !> A mechanism of 4, 6 or 8 moving links and half as many pairs again, near a position in which all of them close.
   subroutine throw_mechanism(d, m)
      type(dice_t), intent(inout) :: d
      type(mechanism_t), intent(out) :: m
      integer :: n, k, i, j

      n = 2*throw(d, 4)
      if (n == 2) n = 6
      allocate (m%links(n + 1), m%points(3*n), m%pairs(3*n/2), m%drives(0), m%requests(0), m%at(1))
      m%at = 0.0_wp
      m%links(1) = link_t('BASE', .true.)
      do k = 1, n
         m%links(k + 1) = link_t('L'//whole(k), position=[decimals(between(d, -5.0_wp, 5.0_wp)), &
            decimals(between(d, -5.0_wp, 5.0_wp)), decimals(between(d, -pi, pi))])
      end do
      do k = 1, size(m%pairs)
         do
            i = throw(d, n + 1)
            j = throw(d, n + 1)
            if (i /= j) exit
         end do
         call throw_pair(d, m, k, i, j)
      end do
      m%requests = [(request_t(subject=k), k=2, n + 1)]
   end subroutine throw_mechanism

   !> Pair number `k` of `m`, of links `i` and `j`.
   subroutine throw_pair(d, m, k, i, j)
      type(dice_t), intent(inout) :: d
      type(mechanism_t), intent(inout) :: m
      integer, intent(in) :: k, i, j
      real(wp) :: place(2), theta

      place = [between(d, -5.0_wp, 5.0_wp), between(d, -5.0_wp, 5.0_wp)]
      m%points(2*k - 1) = point_t('P'//whole(k), i, decimals(in_link(m%links(i), place)))
      m%pairs(k) = pair_t(pair_revolute, 'J'//whole(k), 2*k - 1, 2*k)
      if (chance(d, 0.2_wp)) then
         theta = between(d, -pi, pi)
         place = place + between(d, -2.0_wp, 2.0_wp)*direction(theta)
         m%pairs(k)%kind = pair_prismatic
         m%pairs(k)%alpha = decimals(theta - m%links(i)%position(3))
         m%pairs(k)%beta = m%links(j)%position(3) - m%links(i)%position(3)
      end if
      m%points(2*k) = point_t('Q'//whole(k), j, decimals(in_link(m%links(j), place)))
   end subroutine throw_pair

   !> (2) The coordinates of `place` in the axes of `link`.
   pure function in_link(link, place) result(offset)
      type(link_t), intent(in) :: link
      real(wp), intent(in) :: place(2)
      real(wp) :: offset(2)

      offset = rotated(place - link%position(:2), direction(-link%position(3)))
   end function in_link

   !> `x` as it stands on a card.
   elemental real(wp) function decimals(x)
      real(wp), intent(in) :: x
      character(16) :: text

      text = field(x)
      read (text, *) decimals
   end function decimals

   !> `x` in the columns of a card.
   elemental character(16) function field(x)
      real(wp), intent(in) :: x

      write (field, '(f16.6)') x
   end function field

   !> All links of `m` are in one block, and nothing is too much.
   logical function is_one_block(m) result(is_one)
      type(mechanism_t), intent(in) :: m
      type(structure_report_t) :: f

      is_one = no_part_is_too_stiff(m)
      if (.not. is_one) return
      f = find_structure(m)
      is_one = f%solvable .and. f%redundant == 0
      if (.not. is_one) return
      is_one = size(f%structures) == 1
      if (.not. is_one) return
      associate (list => f%structures(1)%blocks%list)
         is_one = size(list) == 1
         if (is_one) is_one = .not. list(1)%explicit .and. list(1)%shape%n > 2
      end associate
   end function is_one_block

   !> No links have among them more pairs than make them rigid: two equations a pair, three coordinates a link.
   logical function no_part_is_too_stiff(m) result(is_so)
      type(mechanism_t), intent(in) :: m
      integer :: part, i

      is_so = .true.
      do part = 1, 2**size(m%links) - 1
         is_so = is_so .and. 2*count([(btest(part, m%points(m%pairs(i)%point_i)%link - 1) .and. &
            btest(part, m%points(m%pairs(i)%point_j)%link - 1), i=1, size(m%pairs))]) <= 3*(popcnt(part) - 1)
      end do
   end function no_part_is_too_stiff

   !> The deck of `m` on standard output.
   subroutine print_deck(m)
      type(mechanism_t), intent(in) :: m
      integer :: k

      do k = 1, size(m%links)
         call card(merge('GROUND', 'LINK  ', m%links(k)%ground), m%links(k)%name, reals=field(m%links(k)%position))
      end do
      do k = 1, size(m%points)
         call card('POINT', m%points(k)%name, m%links(m%points(k)%link)%name, reals=field(m%points(k)%offset))
      end do
      do k = 1, size(m%pairs)
         associate (p => m%pairs(k), i => m%points(m%pairs(k)%point_i), j => m%points(m%pairs(k)%point_j))
            if (p%kind == pair_revolute) call card('REVOLUTE', i%name, j%name, p%name)
            if (p%kind == pair_prismatic) call card('PRISM', i%name, j%name, p%name, field([p%alpha, p%offset, p%beta]))
         end associate
      end do
      call card('AT', reals=field([0.0_wp]))
      call card('ASSEMBLY')
      call card('END')
   end subroutine print_deck

   !> The polynomials of `m` on standard output. Group: 1, then X and w of each moving link.
   subroutine print_system(m)
      type(mechanism_t), intent(in) :: m
      complex(wp) :: a(2*size(m%pairs), 0:2*size(m%links) - 2), l(0:2*size(m%links) - 2), n(0:2*size(m%links) - 2)
      complex(wp), allocatable :: basis(:, :)
      integer :: k, rows, class(size(m%links))

      rows = 0
      class = [(k, k=1, size(class))]
      do k = 1, size(m%pairs)
         associate (p => m%pairs(k), i => m%points(m%pairs(k)%point_i)%link, j => m%points(m%pairs(k)%point_j)%link)
            rows = rows + 1
            if (p%kind == pair_revolute) a(rows, :) = place_of(m, p%point_i) - place_of(m, p%point_j)
            if (p%kind == pair_prismatic) a(rows, :) = direction_of(m, j) - exp(cmplx(0.0_wp, p%beta, wp)) &
               *direction_of(m, i)
            ! Of links that turn together the first stands for the others.
            if (p%kind == pair_prismatic) then
               where (class == max(class(i), class(j))) class = min(class(i), class(j))
            end if
         end associate
      end do
      call find_null_space(a(:rows, :), 1.0e3_wp*epsilon(1.0_wp), basis)
      write (*, '(i0)') 2*(size(basis, 2) - 1)
      do k = 2, size(m%links)
         if (class(k) /= k) cycle
         call print_product(basis, direction_of(m, k), direction_of(m, k), 1.0_wp, 0.0_wp, -1.0_wp)
      end do
      do k = 1, size(m%pairs)
         associate (p => m%pairs(k))
            if (p%kind /= pair_prismatic) cycle
            l = place_of(m, p%point_i) - place_of(m, p%point_j)
            n = (0.0_wp, 1.0_wp)*exp(cmplx(0.0_wp, p%alpha, wp))*direction_of(m, m%points(p%point_i)%link)
            call print_product(basis, l, n, 0.5_wp, 0.5_wp, -p%offset/unit)
         end associate
      end do
   end subroutine print_system

   !> (0:2 (links - 1)) The direction of link `i` as a linear form of the group.
   function direction_of(m, i) result(l)
      type(mechanism_t), intent(in) :: m
      integer, intent(in) :: i
      complex(wp) :: l(0:2*size(m%links) - 2)

      l = 0.0_wp
      if (i == 1) l(0) = exp(cmplx(0.0_wp, m%links(1)%position(3), wp))
      if (i > 1) l(2*i - 2) = 1.0_wp
   end function direction_of

   !> (0:2 (links - 1)) The place of point `k` likewise.
   function place_of(m, k) result(l)
      type(mechanism_t), intent(in) :: m
      integer, intent(in) :: k
      complex(wp) :: l(0:2*size(m%links) - 2)

      associate (link => m%points(k)%link, offset => m%points(k)%offset)
         l = cmplx(offset(1), offset(2), wp)/unit*direction_of(m, link)
         if (link == 1) l(0) = l(0) + cmplx(m%links(1)%position(1), m%links(1)%position(2), wp)/unit
         if (link > 1) l(2*link - 3) = 1.0_wp
      end associate
   end function place_of

   !> Prints one a b' + other a' b + constant, of the linear forms `a` and `b` and their conjugates.
   subroutine print_product(basis, a, b, one, other, constant)
      complex(wp), intent(in) :: basis(:, :), a(:), b(:)
      real(wp), intent(in) :: one, other, constant
      complex(wp) :: u(size(basis, 2)), v(size(basis, 2)), c
      character(:), allocatable :: unknowns
      integer :: i, j

      u = matmul(a, basis)
      v = matmul(b, basis)
      do i = 1, size(u)
         do j = 1, size(u)
            c = one*u(i)*conjg(v(j)) + other*conjg(u(j))*v(i)
            if (i == 1 .and. j == 1) c = c + constant
            unknowns = ''
            if (i > 1) unknowns = unknowns//'*x'//whole(i - 1)
            if (j > 1) unknowns = unknowns//'*y'//whole(j - 1)
            if (abs(c) > 1.0e-14_wp) &
               write (*, '(a, es24.16, a, es24.16, 3a)') ' + (', real(c), ' + ', aimag(c), '*i)', unknowns
         end do
      end do
      write (*, '(a)') ' ;'
   end subroutine print_product
end program random_blocks
