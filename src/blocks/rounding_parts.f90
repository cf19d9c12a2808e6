!> What bounds of roundings are added up of: the body vectors and cards of each vector loop and of each link of the
!> chain, by the orientations that turn them.
module rounding_parts
   use kinds, only: wp
   use mechanism, only: mechanism_t
   use blocks, only: blocks_t, block_t, loop_components
   use block_engine, only: block_engine_t
   use rounding_changes, only: rounding_response_t
   use card_roundings, only: card_directions, roundings, largest_part, own_in_tables
   implicit none
   private
   public :: part_t, arm_t, rounding_bounds_t, make_rounding_bounds, can_be_bound

   !> What a rounding of the calculation adds to both components of a vector, over its size: at most the root of two.
   real(wp), parameter, public :: own_part = 1.5_wp*largest_part*own_in_tables*epsilon(1.0_wp)
   !> What the rounding of an angle on a card changes of it, over its size.
   real(wp), parameter, public :: angle_part = largest_part*epsilon(1.0_wp)
   !> What turns with one orientation: the length of a vector, and how far the numbers of its cards may be off, with
   !> what is rounded there.
   type :: part_t
      integer :: orientation = 0
      real(wp) :: length = 0.0_wp, card = 0.0_wp
   end type part_t

   !> How a link of the chain hangs on its parent: what turns with the parent, and with itself; the unit of its slide.
   type :: arm_t
      type(part_t) :: parts(2)
      integer :: count = 0                       !< of these that matter
      real(wp) :: slide = 0.0_wp
   end type arm_t

   !> Ready for any motion of a mechanism. Loops have lengths in their units, arms in the deck's.
   type :: rounding_bounds_t
      type(part_t), allocatable :: parts(:)      !< of all loops; in each those that angles of its block turn last
      integer, allocatable :: first(:), first_own(:)   !< (loops + 1), (loops)
      logical, allocatable :: is_plain(:)        !< (loops) there are no slides, and no projection
      type(arm_t), allocatable :: arms(:)        !< (links of the chain)
      real(wp), allocatable :: weights(:), inverse(:), change(:), known(:)   !< room for the widest block
      real(wp), allocatable :: drive(:, :)       !< (0:2, 0:drives) as the state has them
      real(wp), allocatable :: u(:, :)           !< (0:2, 0:unknowns) of values, rates and accelerations
      real(wp), allocatable :: place(:, :)       !< (0:2, 0:links) of the length of a place's change, in the deck's unit
   end type rounding_bounds_t

contains

   !> Ready for the roundings of `m`, which `e` solves, with the sizes and cards of `r`.
   subroutine make_rounding_bounds(b, m, e, r)
      type(rounding_bounds_t), intent(out) :: b
      type(mechanism_t), intent(in) :: m
      class(block_engine_t), intent(in) :: e
      type(rounding_response_t), intent(in) :: r
      integer :: i, n, last

      n = 1
      do i = 1, size(e%blocks%list)
         if (can_be_bound(e%blocks%list(i))) n = max(n, e%blocks%list(i)%shape%n)
      end do
      allocate (b%weights(n**2), b%inverse(n**2), b%change(n), b%known(3*n))
      last = size(e%blocks%body_vectors)
      do i = 1, size(e%blocks%loops)
         last = last + terms_of(e%blocks, i)
      end do
      associate (loops => size(e%blocks%loops))
         allocate (b%parts(last), b%first(loops + 1), b%first_own(loops), b%is_plain(loops))
         last = 0
         do i = 1, loops
            b%first(i) = last + 1
            call gather_parts(b, m, e, r, i, last)
         end do
         b%first(loops + 1) = last + 1
      end associate
      allocate (b%arms(size(e%chain%links)))
      do i = 1, size(b%arms)
         b%arms(i) = arm_of(m, e, r, i)
      end do
      allocate (b%drive(0:2, 0:size(m%drives)), b%u(0:2, 0:e%blocks%unknowns), b%place(0:2, 0:size(m%links)), &
         source=0.0_wp)
   end subroutine make_rounding_bounds

   !> How many cards loop number `i` adds up.
   pure integer function terms_of(b, i)
      type(blocks_t), intent(in) :: b
      integer, intent(in) :: i

      terms_of = 0
      if (b%loops(i)%vector_loop == 0) return
      terms_of = b%first_term(b%loops(i)%vector_loop + 1) - b%first_term(b%loops(i)%vector_loop)
   end function terms_of

   !> The parts of loop number `i`, behind part number `last`: of cards that turn with no body vector, and of the body
   !> vectors in their order.
   subroutine gather_parts(b, m, e, r, i, last)
      type(rounding_bounds_t), intent(inout) :: b
      type(mechanism_t), intent(in) :: m
      class(block_engine_t), intent(in) :: e
      type(rounding_response_t), intent(in) :: r
      integer, intent(in) :: i
      integer, intent(inout) :: last
      integer :: turned_by(terms_of(e%blocks, i)), k

      associate (loop => e%blocks%loops(i), vectors => e%blocks%body_vectors)
         do k = 1, size(turned_by)
            turned_by(k) = orientation_of(m, e, term(k))
         end do
         do k = 1, size(turned_by)
            if (any(turned_by(:k - 1) == turned_by(k)) .or. &
               any(vectors(loop%first_vector:loop%last_vector)%orientation == turned_by(k))) cycle
            last = last + 1
            b%parts(last) = part_t(turned_by(k), 0.0_wp, cards_of(turned_by(k)))
         end do
         b%first_own(i) = last + 1 + loop%first_own - loop%first_vector
         do k = loop%first_vector, loop%last_vector
            last = last + 1
            b%parts(last) = part_t(vectors(k)%orientation, norm2([vectors(k)%x, vectors(k)%y]), &
               cards_of(vectors(k)%orientation))
         end do
         b%is_plain(i) = loop%kind == loop_components .and. loop%last_slide < loop%first_slide
      end associate

   contains

      !> Term number `k` of the loop (2): a point, or the offset of a pair.
      pure function term(k)
         integer, intent(in) :: k
         integer :: term(2)

         term = e%blocks%terms(:, e%blocks%first_term(e%blocks%loops(i)%vector_loop) + k - 1)
      end function term

      !> How far the cards that `orientation` turns may be off, in the loop's unit. Their roundings are added up with
      !> their signs: all points of a ground link are off alike with its place.
      real(wp) function cards_of(orientation) result(off)
         integer, intent(in) :: orientation
         real(wp) :: change(card_directions, 2)
         integer :: k

         change = 0.0_wp
         off = 0.0_wp
         do k = 1, size(turned_by)
            if (turned_by(k) /= orientation) cycle
            associate (card => card_of(m, term(k)))
               change = change + sign(r%cards(:, :, card), r%cards(:, :, card)*real(sum(term(k)), wp))
               off = off + own_part*r%sizes(card)
            end associate
         end do
         off = (off + largest_change(change))/(e%length*e%blocks%loops(i)%unit)
      end function cards_of
   end subroutine gather_parts

   !> The length of the largest of the vectors `x` (card_directions, 2), over `roundings`.
   pure real(wp) function largest_change(x)
      real(wp), intent(in) :: x(:, :)

      largest_change = sqrt(maxval(x(:, 1)**2 + x(:, 2)**2))/roundings
   end function largest_change

   !> The number of the card of `term` (2): point number |term(1)| or, if that is 0, the offset of pair number
   !> |term(2)|.
   pure integer function card_of(m, term)
      type(mechanism_t), intent(in) :: m
      integer, intent(in) :: term(2)

      card_of = abs(term(1))
      if (card_of == 0) card_of = size(m%points) + abs(term(2))
   end function card_of

   !> The orientation that turns it.
   pure integer function orientation_of(m, e, term)
      type(mechanism_t), intent(in) :: m
      class(block_engine_t), intent(in) :: e
      integer, intent(in) :: term(2)
      integer :: point

      point = abs(term(1))
      if (point == 0) point = m%pairs(abs(term(2)))%point_i
      orientation_of = e%orientation_of(m%points(point)%link)
   end function orientation_of

   !> Link number `i` of the chain: see `move_link`.
   pure type(arm_t) function arm_of(m, e, r, i) result(arm)
      type(mechanism_t), intent(in) :: m
      class(block_engine_t), intent(in) :: e
      type(rounding_response_t), intent(in) :: r
      integer, intent(in) :: i
      integer :: own, other

      associate (h => e%chain%links(i))
         if (h%root > 0) return
         associate (pair => m%pairs(h%pair))
            own = merge(pair%point_i, pair%point_j, m%points(pair%point_i)%link == h%link)
            other = pair%point_i + pair%point_j - own
         end associate
         arm%parts(1) = part_t(h%parent_orientation, norm2(h%place%reach), off(other))
         arm%parts(2) = part_t(h%orientation, norm2(h%place%body_vector), off(own))
         arm%count = merge(2, 1, max(arm%parts(2)%length, arm%parts(2)%card) > 0.0_wp)
         if (h%slide == 0) return
         arm%parts(1)%card = arm%parts(1)%card + off(size(m%points) + h%pair)
         arm%slide = e%length*norm2(h%place%slide_body_vector)
      end associate

   contains

      !> How far `card` may be off.
      pure real(wp) function off(card)
         integer, intent(in) :: card

         off = largest_change(r%cards(:, :, card)) + own_part*r%sizes(card)
      end function off
   end function arm_of

   !> The inverse of the Jacobian of `block` takes less time than an estimate would.
   pure logical function can_be_bound(block)
      type(block_t), intent(in) :: block

      can_be_bound = block%shape%pattern == 0 .and. block%shape%rows == block%shape%n
   end function can_be_bound
end module rounding_parts
